"""Laws that stop a train at a platform: "ILC", He and Tang 2016, and ours.

The paper's law cleans the speed by a wavelet packet, begins to brake where the braking curve of the model meets the
stopping point, and learns from run to run. Its reconstruction (equations (1) to (7) below are those of the
reconstruction) and the open points are in :mod:`.model`, :mod:`.laws.ilc_stop` and :mod:`.learning`.
"""
