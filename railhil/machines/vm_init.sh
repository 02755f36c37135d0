#!/bin/busybox sh
# First process of the test machine: load the modules, see the host's root read-only under a throw-away
# overlay, bring the CAN interfaces up, run the one command, hand its exit code back, power off.
/bin/busybox mkdir -p /proc /sys /dev /host /layer /new /sbin /usr/bin /usr/sbin
/bin/busybox --install -s
mount -t proc proc /proc
mount -t sysfs sysfs /sys
mount -t devtmpfs devtmpfs /dev
say() { echo "railhil-vm: $*" >/dev/console; }

while read -r module; do
    insmod "/modules/$module" || say "module $module does not load"
done </modules/order

# A folder of the host: see TAG PATH TARGET. A user-mode kernel opens the host's files itself, and its command line says
# where the control folder is (railhil=PATH); an emulated machine is given them under a tag.
nine=trans=virtio,version=9p2000.L,msize=524288
if [ -n "${railhil:-}" ]; then
    mount -t hostfs -o / root /host && mount -o remount,ro /host || say "the host's root does not mount"
    see() { mount -t hostfs -o "$2" "$1" "$3"; }
    out=/dev/tty1 err=/dev/tty2 disk=ubd
    for port in $out $err; do stty -F $port raw -echo; done
else
    mount -t 9p -o $nine,ro,cache=loose root /host || say "the host's root does not mount"
    see() { mount -t 9p -o $nine "$1" "$3"; }
    out=/dev/vport0p1 err=/dev/vport0p2 disk=vd
fi
mount -t tmpfs -o mode=755 layer /layer
mkdir /layer/upper /layer/work
mount -t overlay -o lowerdir=/host,upperdir=/layer/upper,workdir=/layer/work root /new || say "no overlay"
mount -t proc proc /new/proc
mount -t sysfs sysfs /new/sys
mount -t devtmpfs devtmpfs /new/dev
mkdir -p /new/dev/pts /new/dev/shm
mount -t devpts -o mode=620,ptmxmode=666 devpts /new/dev/pts
mount -t tmpfs -o mode=1777 shm /new/dev/shm
mount -t tmpfs -o mode=755 run /new/run
mkdir -p /new/run/lock /new/run/railhil-vm
see control "${railhil:-}" /new/run/railhil-vm || say "the control folder does not mount"
control=/new/run/railhil-vm
while read -r tag path; do
    mkdir -p "/new$path"
    see "$tag" "$path" "/new$path" || say "share $path does not mount"
done <$control/shares
while read -r letter path; do
    mkdir -p "/new$path"
    mount -t ext4 "/dev/$disk$letter" "/new$path" || say "disk $path does not mount"
done <$control/disks
# Version 1 hierarchies, one per controller, for older container runtimes.
mount -t tmpfs -o mode=755 cgroup /new/sys/fs/cgroup
while read -r controller _ _ enabled; do
    [ "$enabled" = 1 ] || continue
    mkdir "/new/sys/fs/cgroup/$controller"
    mount -t cgroup -o "$controller" cgroup "/new/sys/fs/cgroup/$controller" || say "no cgroup $controller"
done </proc/cgroups

ip link set lo up
while read -r interface; do
    ip link add "$interface" type vcan && ip link set "$interface" up || say "no $interface"
done <$control/interfaces

# The command writes to pipes, not to the ports: a port cannot be opened twice, /dev/stdout must be.
mkfifo /out /err
cat </out >$out &
copy_out=$!
cat </err >$err &
copy_err=$!
touch $control/began
# In a mount namespace of its own the new root can become the real one; in a mere chroot the kernel refuses user
# namespaces.
unshare -m /bin/sh -c 'cd /new && mount --move . / && exec chroot . /bin/sh /run/railhil-vm/command' >/out 2>/err </dev/null
echo $? >$control/exit_code.part
mv $control/exit_code.part $control/exit_code
# Processes that the command left running may hold the pipes; the rest of its output gets five seconds.
(sleep 5; kill $copy_out $copy_err) 2>/dev/null &
wait $copy_out $copy_err
sync
poweroff -f
