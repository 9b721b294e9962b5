#!/usr/bin/python3
"""Time per ray over the number of primitives, from a result of `raybench bench scaling`.

usage: scripts/plot_scaling.py [RESULT [FILE.svg]]    (default: results/latest, scaling.svg)

A panel for each generator and kernel, a line for each variant, camera rays and what they spawn.
"""
import collections
import csv
import os
import re
import sys

KEY = ["scene", "width", "height", "depth", "aa", "light_samples", "tile", "variant", "threads"]


def read(folder, name):
    try:
        with open(os.path.join(folder, name), newline="") as file:
            return list(csv.DictReader(file))
    except OSError as problem:
        sys.exit("plot_scaling: %s" % problem)


def curves(folder):
    """{(generator, kernel): {(variant, bounce): [(primitives, ns per ray)]}}"""
    sizes = {tuple(row[k] for k in KEY): row["primitives"] for row in read(folder, "frame.csv")}
    panels = collections.defaultdict(lambda: collections.defaultdict(list))
    for row in read(folder, "kernels.csv"):
        scene = re.fullmatch(r"(\D+)\d+", row["scene"])
        size = sizes.get(tuple(row[k] for k in KEY))
        if scene and size and row["kernel"].startswith("trace") and row["ns_per_ray"]:
            name = "%s x %s, bounce %s" % (row["variant"], row["threads"], row["bounce"])
            point = float(size), float(row["ns_per_ray"])
            panels[scene[1], row["kernel"]][name].append(point)
    return panels


def main(folder="results/latest", path="scaling.svg"):
    try:
        import matplotlib
    except ImportError:
        sys.exit("plot_scaling: needs matplotlib: apt-get install python3-matplotlib")
    matplotlib.use("svg")
    import matplotlib.pyplot as plot

    panels = curves(folder)
    if not panels:
        sys.exit("plot_scaling: %s: no times of generated scenes, balls3 or mount5" % folder)
    _, axes = plot.subplots(1, len(panels), figsize=(5 * len(panels), 4), squeeze=False)
    for axis, ((generator, kernel), lines) in zip(axes[0], sorted(panels.items())):
        for name, points in sorted(lines.items()):
            axis.semilogx(*zip(*sorted(points)), marker="o", label=name)
        axis.set(title="%s, %s" % (generator, kernel), xlabel="primitives", ylabel="ns per ray")
        axis.set_ylim(bottom=0)
        axis.legend(fontsize="small")
    plot.tight_layout()
    plot.savefig(path)


if len(sys.argv) > 3 or any(word.startswith("-") for word in sys.argv[1:]):
    sys.exit(__doc__)
main(*sys.argv[1:])
