"""The laws of the system ``ato``, one a module of its name."""

#: The order of these laws in every table, legend and list: as in Table 2 of Wang et al. (DOI
#: 10.19650/j.cnki.cjsi.J2108765), where the others are compared with the first. Then railhil's own.
ORDER = ("ipfc", "tpfc2", "tpfc1", "tdmc", "fuzzy_pid", "ipfc_plus", "ipfc_plus_stop")
