"""Section 4: time per ray, by kernel and bounce."""
import matplotlib

import draw
from data import KERNELS, number
from page import Figure, Section

SHARES = KERNELS + ["resolve", "other"]


def bounces(grid):
    return ["%d" % b for b in grid.columns]


def heat_figure(result, scene, variants, column, unit, name):
    """A panel for each row, a cell for each kernel and bounce, one scale for all of them."""
    grids = [(v, result.grid(scene, v, column)) for v in variants]
    grids = [(v, g) for v, g in grids if g.notna().any().any()]
    if not grids:
        return None
    values = [x for _, g in grids for x in g.to_numpy().ravel() if x == x and x > 0]
    norm = matplotlib.colors.LogNorm(min(values), max(max(values), min(values) * 1.01))
    figure, axes = draw.grid(len(grids), 3, 3.1, 1.9)
    for axis, (variant, grid) in zip(axes, grids):
        draw.heat(axis, grid, norm, number, bounces(grid), KERNELS)
        axis.set(title=variant, xlabel="bounce")
    figure.suptitle("%s, %s, colours logarithmic" % (scene, unit), fontsize=10)
    dear = max(
        (
            (g.loc[k, b], v, k, b)
            for v, g in grids
            for k in g.index
            for b in g.columns
            if g.loc[k, b] == g.loc[k, b]
        )
    )
    return Figure(
        name,
        draw.finish(figure, name),
        "%s in %s by kernel and bounce, of %s. The most: %s for %s at bounce %d of %s."
        % (
            unit,
            scene,
            ", ".join(v for v, _ in grids),
            number(dear[0]),
            dear[2],
            dear[3],
            dear[1],
        ),
    )


def alive_figure(result):
    """How many rays there are at each bounce."""
    figure, axes = draw.panels(1, 2, 4, 2.9)
    said = []
    for i, scene in enumerate(result.scenes):
        rows = result.serial_rows(scene)
        if not rows:
            continue
        grid = result.grid(scene, rows[0], "rays")
        for axis, kernel in zip(axes[0], ("trace", "trace_shadow")):
            line = grid.loc[kernel].dropna()
            axis.semilogy(
                line.index, line, color=draw.colour(i), marker=draw.marker(i), label=scene
            )
        trace = grid.loc["trace"].dropna()
        if len(trace):
            said.append("%s from %d to %d" % (scene, trace.iloc[0], trace.iloc[-1]))
    for axis, kernel in zip(axes[0], ("trace", "trace_shadow")):
        axis.set(title=kernel, xlabel="bounce", ylabel="rays (logarithmic)")
        axis.xaxis.set_major_locator(matplotlib.ticker.MaxNLocator(integer=True))
    draw.legend(figure, *axes[0][0].get_legend_handles_labels(), columns=3)
    return Figure(
        "alive",
        draw.finish(figure, "alive"),
        "Rays traced, from the first bounce to the " "last: " + "; ".join(said),
        "Rays alive at each bounce.",
    )


def shares(result, scene, variant):
    """{kernel: percent of the frame}, all bounces together."""
    k = result.kernels
    k = k[(k["scene"] == scene) & (k["variant"] == variant)]
    return {kernel: k.loc[k["kernel"] == kernel, "share_pct"].sum() for kernel in SHARES}


def share_figure(result):
    """Where a frame's time goes, a bar for each row of each scene."""
    scenes = [s for s in result.scenes if result.serial_rows(s)]
    rows = max((result.serial_rows(s) for s in scenes), key=len)
    figure, axes = draw.grid(len(scenes), 3, 3.2, 0.9 + 0.3 * len(rows))
    said = []
    for axis, scene in zip(axes, scenes):
        present = result.serial_rows(scene)
        table = [shares(result, scene, v) for v in present]
        left = [0.0] * len(present)
        for i, kernel in enumerate(SHARES):
            values = [line[kernel] for line in table]
            axis.barh(
                present,
                values,
                left=left,
                color=draw.colour(i),
                label=kernel,
                edgecolor=draw.PAPER,
                linewidth=0.6,
            )
            left = [a + b for a, b in zip(left, values)]
        axis.set(title=scene, xlim=(0, 100), xlabel="percent of the frame")
        axis.invert_yaxis()
        said += [
            "%s %s trace and trace_shadow %s %%"
            % (scene, v, number(t["trace"] + t["trace_shadow"]))
            for v, t in zip(present, table)
        ]
    draw.legend(figure, *axes[0].get_legend_handles_labels(), columns=6)
    return Figure(
        "shares",
        draw.finish(figure, "shares"),
        "Shares of the frame: " + "; ".join(said),
        "Share of the frame's time, one thread.",
    )


def section(results):
    result, blocks, missing = results.main, [], []
    timed = result.kernels[
        result.kernels["ns_per_ray"].notna() & result.kernels["bounce"].notna()
    ]
    if timed.empty:
        return Section(
            "kernels",
            "Time per ray",
            "No kernel has a time.",
            [],
            ["Times by kernel and bounce: `raybench bench` with `--measure time`."],
        )
    for scene in result.scenes:
        figure = heat_figure(
            result, scene, result.serial_rows(scene), "ns_per_ray", "ns per ray", "ns-" + scene
        )
        if figure:
            blocks.append(figure)
        else:
            missing.append("%s: no times by kernel and bounce" % scene)
    blocks += [alive_figure(result), share_figure(result)]
    growth = {}
    for scene in result.scenes:
        best = result.fastest(scene)
        line = (
            None
            if best is None
            else result.grid(scene, best["variant"], "ns_per_ray").loc["trace"]
        )
        line = [] if line is None else line.dropna()
        if len(line) > 1:
            growth[scene] = (line.iloc[-1] / line.iloc[0], line.iloc[0], line.iloc[-1])
    finding = "Times stand below."
    if growth:
        scene = max(growth, key=growth.get)
        finding = (
            "A ray grows dearer with each bounce: on %s, tracing one with the fastest row takes "
            "%s ns at the camera and %s ns at the last bounce, %s times as much."
            % (
                scene,
                number(growth[scene][1]),
                number(growth[scene][2]),
                number(growth[scene][0]),
            )
        )
    return Section("kernels", "Time per ray, by kernel and bounce", finding, blocks, missing)
