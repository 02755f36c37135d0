"""Meaning of the keys of ``[atp]``; :mod:`railhil.scenarios.reference` adds unit, range and default.

A default that depends on the profile stands here: metro, and in brackets subset026.
"""

from __future__ import annotations

#: By dotted key.
ATP_MEANING = {
    "atp.enabled": "whether the train has a protection",
    "atp.profile": "where the values come from that are not given: metro, or times and increments of subset026 "
    "(no conformity claimed)",
    "atp.emergency_mps2": "emergency brake on the nominal mass: a value, or rows [from km/h, m/s2]; 1.2",
    "atp.k_dry": "guaranteed share of it on dry rails: a value, or rows [from km/h, share]; 0.85",
    "atp.k_wet": "share of that on wet rails, likewise; 0.9",
    "atp.m_avadh": "how much of the loss on wet rails does not count, 0 to 1; 0",
    "atp.a_max_reduced_mps2": "most that low adhesion lets the emergency brake give (default: no limit)",
    "atp.service_mps2": "expected service brake: a value, or rows [from km/h, m/s2]; 0.9",
    "atp.t_be_s": "equivalent dead time of the emergency brake, at least its dead time plus its lag; 1.2 [3.0]",
    "atp.t_bs_s": "likewise of the service brake; 0.8 [4.0]",
    "atp.t_cut_s": "time until no traction acts after the cut; 0.7 [8.0]",
    "atp.t_warning_s": "time between warning and service brake; 0.5 [2]",
    "atp.t_driver_s": "time between permitted speed and service brake; 1.0 [4]",
    "atp.t_ind_min_s": "least time between indication and permitted speed; 3 [5]",
    "atp.eoa_overlap_m": "end of authority behind a stop, where the stop has no own; 10",
    "atp.svl_overlap_m": "supervised location behind a stop, likewise; 30",
    "atp.v_release_kmh": "largest release speed; 5",
    "atp.d_trip_m": "from the end of authority to the place at which a train trips; 2",
    "atp.rotating_percent": 'rotating masses, or "unknown" (15 uphill, 2 downhill); default: those of the train',
    "atp.increments": "speeds above a ceiling at which the reactions begin: metro 2, 3, 5 km/h, or subset026",
    "atp.over_reading": "share by which the odometer may read too much; 0.02",
    "atp.under_reading": "share by which it may read too little; 0.02",
    "atp.balise_accuracy_m": "accuracy of a balise's position; 0.5",
    "atp.balise_spacing_m": "the protection has balises of its own where those of the line lie further apart; "
    "0: none; 300",
    "atp.ato_margin_m": "least way of a target curve to the braking curves of the permitted speed; 2",
    "atp.ato_margin_kmh": "least distance of a target curve from the ceilings; 1",
    "atp.heed_atp": "the controller takes traction off 0.5 s before it would reach the permitted speed",
}
