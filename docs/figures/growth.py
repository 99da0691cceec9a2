"""Draws a run as FMPy wrote it: time history, spectrum over time, shares of the contact states.

    python docs/figures/growth.py set1.csv set1.png

Needs numpy and matplotlib.
"""

import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

SIGNAL = "module[1].v1"
STATES = ["Sl: sliding", "R-Sl: reverse sliding", "St: sticking", "Dt: detached"]
# Okabe and Ito's palette: told apart by the colour-blind.
COLOURS = ["#56B4E9", "#009E73", "#D55E00", "#000000"]
WINDOW = 0.15  # s, of the spectrum: 7 Hz apart are told apart


def read(path):
    with open(path, encoding="utf-8") as file:
        names = [name.strip('"') for name in file.readline().strip().split(",")]
        rows = np.loadtxt(file, delimiter=",")
    return dict(zip(names, rows.T))


def draw(run, target):
    time, signal = run["time"], run[SIGNAL]
    rate = 1.0 / np.median(np.diff(time))
    figure, (history, spectrum, states) = plt.subplots(
        3, 1, figsize=(9, 7), sharex=True, height_ratios=[3, 3, 1.2], layout="constrained"
    )

    history.plot(time, signal, color="#0072B2", linewidth=0.3)
    history.set_ylabel("velocity of m1, module 1\n(horizontal) [m/s]")
    history.grid(alpha=0.3)

    length = int(WINDOW * rate)
    power, frequencies, times, image = spectrum.specgram(
        signal, NFFT=length, Fs=rate, noverlap=length * 9 // 10, window=np.hanning(length),
        scale="dB", cmap="cividis",
    )
    top = 10 * np.log10(power.max())
    image.set_clim(top - 60, top)
    spectrum.set_ylim(120, 280)
    spectrum.set_ylabel("frequency [Hz]")
    figure.colorbar(image, ax=spectrum, label="power [dB], 60 dB shown", pad=0.01)

    # Share of the time that the contacts spend in each state, over twentieths of a second.
    edges = np.arange(0.0, time[-1], 0.05)
    bins = np.digitize(time, edges) - 1
    codes = np.stack([run[name] for name in run if name.endswith("].state")])
    shares = np.array([
        [np.mean(codes[:, bins == b] == code) for b in range(len(edges))] for code in range(1, 5)
    ])
    used = [i for i in range(4) if shares[i].max() > 0]
    # The last share holds to the end.
    edges = np.append(edges, time[-1])
    shares = np.hstack([shares, shares[:, -1:]])
    states.stackplot(
        edges, 100 * shares[used], labels=[STATES[i] for i in used],
        colors=[COLOURS[i] for i in used], step="post",
    )
    states.set_ylabel("share of\ntime [%]")
    states.set_ylim(0, 100)
    states.set_xlim(0, time[-1])
    states.set_xlabel("time [s]")
    states.legend(loc="lower left", ncols=4)
    figure.savefig(target, dpi=130)


if __name__ == "__main__":
    draw(read(sys.argv[1]), sys.argv[2])
