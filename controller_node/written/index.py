"""Functions by the digest of a program's shape. Written by ``make tables`` from the recorded program; do not edit."""

from __future__ import annotations

#: Digest -> module and function.
FUNCTIONS: dict[str, str] = {
    "e53364eb114c9c5a": "ipfc_fixed:inputs_by_time",
    "2b40104b385eac08": "ipfc_fixed:step",
    "8e2be6d1bfaab77a": "ipfc_fixed:inputs_by_distance",
    "813579d29d6f7079": "ipfc_float64:inputs_by_time",
    "5b1b9384a5be147f": "ipfc_float64:step",
    "ade7c0f6b2ae0a3a": "ipfc_float64:inputs_by_distance",
    "46e8431f9946dc24": "tpfc1_fixed:step",
    "4b4acbd748dc5bbf": "tpfc1_float64:step",
    "0c98566be68bcbf0": "tpfc2_fixed:step",
    "859daa345aa5c42f": "tpfc2_float64:step",
    "152c032db6fa7912": "tdmc_fixed:inputs_by_time",
    "cd411b19e5b1e2b1": "tdmc_fixed:step",
    "66f6de45a962c579": "tdmc_fixed:inputs_by_distance",
    "66dcfec7bfdfde3e": "tdmc_float64:inputs_by_time",
    "4a1e0c4a59dde1eb": "tdmc_float64:step",
    "91790c1a3c0ca3d1": "tdmc_float64:inputs_by_distance",
    "b3e7a0a290436d88": "fuzzy_pid_fixed:inputs_by_time",
    "b63c196ba0e0d521": "fuzzy_pid_fixed:step",
    "ddf8315fac355c12": "fuzzy_pid_fixed:inputs_by_distance",
    "74fd46975ee5733d": "fuzzy_pid_float64:inputs_by_time",
    "63cfd0a7209c8287": "fuzzy_pid_float64:step",
    "b5d825a35420a6e4": "fuzzy_pid_float64:inputs_by_distance",
    "85aa1451a80de760": "ipfc_plus_fixed:inputs_by_time",
    "eb3275fe85e98626": "ipfc_plus_fixed:step",
    "3783437f639e8f50": "ipfc_plus_fixed:step_2",
    "a40bf83cd2ef1b1a": "ipfc_plus_float64:inputs_by_time",
    "c8d5f95c83f4e3d0": "ipfc_plus_float64:step",
    "b7389730c8fc915e": "ipfc_plus_stop_fixed:step",
    "d9badf9b894a2486": "ipfc_plus_stop_fixed:step_1",
    "26242b6b5138add5": "ipfc_plus_stop_float64:step",
}
