"""Write ``taps.json`` and the golden cases of its test: ``python make_taps.py TAPS.json GOLDEN.json``.

The only place that needs PyWavelets (1.9.0; numpy and scipy besides): with a fixed window, "decompose, keep node aaa,
rebuild, read one sample" is a fixed linear operator, so a law needs nothing but its row of numbers. Run it by its path
in an environment of its own (``pip install PyWavelets==1.9.0 scipy``); it imports nothing of railhil.
"""

from __future__ import annotations

import hashlib
import json
import sys
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import pywt
from numpy.typing import NDArray
from scipy.signal import butter, firwin

FloatArray: TypeAlias = NDArray[np.float64]

WAVELET = "db8"
LEVELS = 3
#: Samples in the window of the packet.
WINDOW = 128
#: Samples a second.
RATE_HZ = 312.5
MODES = ("symmetric", "antireflect")
#: Number of samples behind the newest one at which the packet is read.
LAGS = (0, 8, 63)


def packet(window: FloatArray, mode: str) -> FloatArray:
    """Equation (3): the wavelet packet of the window with all nodes of the last level but ``aaa`` set to zero."""
    tree = pywt.WaveletPacket(window, WAVELET, mode=mode, maxlevel=LEVELS)
    kept = pywt.WaveletPacket(None, WAVELET, mode=mode, maxlevel=LEVELS)
    kept["a" * LEVELS] = tree["a" * LEVELS].data
    return np.asarray(kept.reconstruct(update=False))[: len(window)]


def approximation(window: FloatArray, mode: str) -> FloatArray:
    """The same by the plain wavelet transform: its approximation of the last level."""
    parts = pywt.wavedec(window, WAVELET, mode=mode, level=LEVELS)
    kept = [parts[0], *(np.zeros_like(part) for part in parts[1:])]
    return np.asarray(pywt.waverec(kept, WAVELET, mode=mode))[: len(window)]


def taps() -> dict[str, list[float]]:
    """Weights of the samples of a window, oldest first, by the name of the filter."""
    found: dict[str, list[float]] = {}
    for mode in MODES:
        operator = np.array([packet(row, mode) for row in np.eye(WINDOW)]).T
        for lag in LAGS:
            found[f"packet_{mode}_{lag}"] = operator[WINDOW - 1 - lag].tolist()
    found["fir65_10hz"] = firwin(65, 10.0, fs=RATE_HZ).tolist()
    b, a = butter(2, 2.0, fs=RATE_HZ)
    found["butterworth2_2hz_b"], found["butterworth2_2hz_a"] = b.tolist(), a.tolist()
    return found


def golden() -> list[dict[str, Any]]:
    """Windows of speeds (m/s) and their results by PyWavelets."""
    random = np.random.default_rng(14)
    time_s = np.arange(WINDOW) / RATE_HZ
    windows = {
        "constant": np.full(WINDOW, 16.667),
        "noise": 0.01 * random.standard_normal(WINDOW),
        "cruise": 16.667 + 0.01 * random.standard_normal(WINDOW),
        "braking": 16.667 - 0.8 * time_s + 0.05 * random.standard_normal(WINDOW),
        "corner": 16.667 - 0.8 * np.maximum(time_s - 0.2, 0.0),
        "newest": np.eye(WINDOW)[-1],
    }
    cases = []
    for name, window in windows.items():
        rounded = np.round(window, 6)
        for mode in MODES:
            found = packet(rounded, mode)
            plain = approximation(rounded, mode)
            cases.append(
                {
                    "name": name,
                    "mode": mode,
                    "window_mps": rounded.tolist(),
                    "packet_mps": {str(lag): float(found[WINDOW - 1 - lag]) for lag in LAGS},
                    "approximation_mps": {str(lag): float(plain[WINDOW - 1 - lag]) for lag in LAGS},
                }
            )
    return cases


def main(taps_path: str, golden_path: str) -> None:
    """Write both files."""
    found = taps()
    text = json.dumps(found, sort_keys=True, separators=(",", ":"))
    document = {
        "made_by": f"make_taps.py, PyWavelets {pywt.__version__}",
        "wavelet": WAVELET,
        "low_pass": list(pywt.Wavelet(WAVELET).dec_lo),
        "rate_hz": RATE_HZ,
        "taps_sha256": hashlib.sha256(text.encode()).hexdigest(),
        "taps": found,
    }
    Path(taps_path).write_text(json.dumps(document, indent=1) + "\n", encoding="utf-8", newline="\n")
    Path(golden_path).write_text(json.dumps(golden(), indent=1) + "\n", encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
