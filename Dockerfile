# The bench in one small image; docker-compose.yml gives each container its role.
# BASE can be another Debian 12 image, for a host with a mirror of its own.
ARG BASE=debian:bookworm-slim

FROM ${BASE} AS build
RUN apt-get update && apt-get install -y --no-install-recommends python3-venv
RUN python3 -m venv /opt/railhil
WORKDIR /src
# Dependencies before sources: a change of code does not fetch them again.
COPY pyproject.toml ./
# What a run, its report and its panel need. "report panel campaign" adds numba (LLVM) and Arrow, 350 MB.
ARG EXTRAS="report panel"
RUN python3 -c 'import sys, tomllib; p = tomllib.load(open("pyproject.toml", "rb"))["project"]; \
print("\n".join(p["dependencies"] + [one for name in sys.argv[1:] for one in p["optional-dependencies"][name]]))' \
        $EXTRAS >/requirements.txt \
    && /opt/railhil/bin/pip install --no-cache-dir --only-binary=:all: -r /requirements.txt
# 1: the modules of setup.py compiled for the processor of the image, some minutes.
ARG RAILHIL_COMPILED=0
RUN if [ "$RAILHIL_COMPILED" != 0 ]; then \
    apt-get update && apt-get install -y --no-install-recommends gcc libc6-dev python3-dev; fi
COPY . ./
# The commit, which an image cannot ask of git (docs/howto/release.md).
ARG RAILHIL_LABEL=+unknown
# Not used at run time, a third of the size: pip itself, the libraries' own test suites, and the files for compilers and
# type checkers.
RUN /opt/railhil/bin/pip install --no-cache-dir --no-deps . \
    && /opt/railhil/bin/pip uninstall -y pip setuptools \
    && find /opt/railhil -type d -name tests -prune -exec rm -rf {} + \
    && find /opt/railhil -type f \( -name '*.pyi' -o -name '*.pxd' -o -name '*.h' -o -name '*.c' -o -name '*.a' \) \
        ! -path '*/controller_node/*' -delete

FROM ${BASE}
# The file capability lets the unprivileged user of the bus service, the one that is granted NET_ADMIN, make vcan0.
# It is busybox's ip, because iproute2's gives file capabilities away when it starts.
RUN apt-get update \
    && apt-get install -y --no-install-recommends busybox libcap2-bin python3 \
    && cp /bin/busybox /usr/local/bin/ip && setcap cap_net_admin+ep /usr/local/bin/ip \
    && apt-get purge -y busybox libcap2-bin \
    && rm -rf /var/lib/apt/lists/* /var/cache/apt /var/log/*
COPY --from=build /opt/railhil /opt/railhil
COPY docker/bench.sh /usr/local/bin/bench
ENV PATH=/opt/railhil/bin:/usr/local/bin:/usr/bin:/bin HOME=/tmp PYTHONUNBUFFERED=1
USER 1000:1000
WORKDIR /tmp
ENTRYPOINT ["bench"]
