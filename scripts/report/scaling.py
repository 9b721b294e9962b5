"""Section 8: more threads, more primitives."""
import re

import numpy

import draw
from data import number, ordered
from page import Figure, Section


def threads_figure(result):
    """Throughput over threads, the ideal beside it; efficiency and imbalance."""
    frames = result.timed()
    frames = frames[frames["variant"].str.endswith("+omp")]
    figure, axes = draw.panels(1, 3, 3.2, 2.8)
    said = []
    for i, ((scene, variant), rows) in enumerate(
        frames.groupby(["scene", "variant"], sort=False)
    ):
        rows = rows.sort_values("threads")
        if len(rows) < 2:
            continue
        one = rows.iloc[0]
        speedup = one["frame_ms"] / rows["frame_ms"] * one["threads"]
        options = {
            "color": draw.colour(i),
            "marker": draw.marker(i),
            "label": "%s, %s" % (scene, variant),
        }
        axes[0][0].plot(rows["threads"], speedup, **options)
        axes[0][1].plot(rows["threads"], 100 * speedup / rows["threads"], **options)
        axes[0][2].plot(rows["threads"], 100 * rows["imbalance"], **options)
        said.append(
            "%s %s: %s times with %d threads"
            % (scene, variant, number(speedup.iloc[-1]), rows["threads"].iloc[-1])
        )
    most = frames["threads"].max()
    axes[0][0].plot(
        [1, most], [1, most], color=draw.FAINT, linestyle="--", zorder=0, label="ideal"
    )
    for axis, label in zip(axes[0], ("times one thread", "efficiency, %", "imbalance, %")):
        axis.set(
            xlabel="threads", ylabel=label, ylim=(0, None), xticks=sorted(set(frames["threads"]))
        )
    draw.legend(figure, *axes[0][0].get_legend_handles_labels(), columns=3)
    return (
        Figure(
            "threads",
            draw.finish(figure, "threads"),
            "Speed-up by threads: " + "; ".join(said),
            "Threads: throughput, efficiency, imbalance.",
        ),
        said,
    )


def curves(result):
    """{(generator, kernel, bounce, row): [(primitives, ns per ray, tree bytes)]}"""
    sizes = result.frames.set_index(["scene", "variant", "threads"])[
        ["primitives", "tree_bytes"]
    ]
    lines = {}
    k = result.kernels[result.kernels["kernel"].isin(("trace", "trace_shadow"))]
    for place in k[k["ns_per_ray"].notna() & k["bounce"].notna()].itertuples():
        generator = re.match(r"[a-z]+", place.scene)[0]
        key = place.scene, place.variant, place.threads
        if key in sizes.index and re.fullmatch(r"[a-z]+\d+", place.scene):
            size = sizes.loc[key]
            lines.setdefault((generator, place.kernel, int(place.bounce), place.row), []).append(
                (size["primitives"], place.ns_per_ray, size["tree_bytes"])
            )
    return {key: sorted(points) for key, points in lines.items() if len(points) > 2}


def slope(points):
    """ns per ray for each factor of ten in primitives, and how well that line fits (R squared)."""
    x, y = numpy.log10([p[0] for p in points]), numpy.array([p[1] for p in points])
    a, b = numpy.polyfit(x, y, 1)
    spread = ((y - y.mean()) ** 2).sum()
    return a, 1 - ((y - a * x - b) ** 2).sum() / spread if spread else float("nan")


def mark_caches(axis, points, caches):
    """Where the tree outgrows each cache, by interpolation in the logarithm."""
    primitives, _, sizes = zip(*points)
    for cache in caches:
        if cache["type"] != "Instruction" and sizes[0] < cache["bytes"] < sizes[-1]:
            x = 10 ** numpy.interp(
                numpy.log10(cache["bytes"]), numpy.log10(sizes), numpy.log10(primitives)
            )
            axis.axvline(x, color=draw.FAINT, linewidth=1)
            axis.text(x, axis.get_ylim()[1], " L%d" % cache["level"], va="top", fontsize=7)


def size_figure(result):
    lines = curves(result)
    shown = ordered((key[0], key[1]) for key in lines)
    rows = ordered((key[3], key[2]) for key in lines)
    figure, axes = draw.panels(1, len(shown), 3.4, 3)
    said, slopes = [], []
    for axis, (generator, kernel) in zip(axes[0], shown):
        for (g, k, bounce, row), points in lines.items():
            if (g, k) != (generator, kernel):
                continue
            i = rows.index((row, bounce))
            x, y, _ = zip(*points)
            axis.semilogx(
                x,
                y,
                color=draw.colour(i),
                marker=draw.marker(i),
                markersize=4,
                label="%s, bounce %d" % (row, bounce),
            )
            per_decade, fit = slope(points)
            slopes.append((generator, kernel, bounce, row, per_decade, fit))
            said.append(
                "%s %s bounce %d %s: %s ns for each factor of ten"
                % (g, k, bounce, row, number(per_decade))
            )
        axis.set(
            title="%s, %s" % (generator, kernel),
            xlabel="primitives (logarithmic)",
            ylabel="ns per ray",
            ylim=(0, None),
        )
        mark_caches(
            axis,
            max((p for key, p in lines.items() if key[:2] == (generator, kernel)), key=len),
            result.fact("cpu", "caches", default=[]),
        )
    draw.legend(figure, *axes[0][0].get_legend_handles_labels())
    return (
        Figure(
            "sizes",
            draw.finish(figure, "sizes"),
            "Time per ray by scene size. " + "; ".join(said),
            "Time per ray over primitives; grey lines: there the tree outgrows a cache.",
        ),
        slopes,
    )


def misses(result):
    """{(kernel, bounce): [(primitives, last-level misses a ray, memory stall in %)]}, of bvh"""
    sizes = (
        result.frames[result.frames["variant"] == "bvh"]
        .set_index("scene")["primitives"]
        .dropna()
    )
    k = result.kernels[result.kernels["kernel"].isin(("trace", "trace_shadow"))]
    k = k[k["llc_misses_per_ray"].notna() & k["bounce"].isin((0, 1)) & (k["variant"] == "bvh")]
    lines = {}
    for place in k[k["scene"].isin(sizes.index)].itertuples():
        lines.setdefault((place.kernel, int(place.bounce)), []).append(
            (sizes[place.scene], place.llc_misses_per_ray, place.memory_stall_pct)
        )
    return {key: sorted(points) for key, points in lines.items() if len(points) > 2}


def misses_figure(result):
    lines, said = misses(result), []
    figure, axes = draw.panels(1, 2, 4, 2.8)
    for i, ((kernel, bounce), points) in enumerate(lines.items()):
        size, missed, stalled = zip(*points)
        name = "%s, bounce %d" % (kernel, bounce)
        for axis, values in zip(axes[0], (missed, stalled)):
            axis.semilogx(
                size,
                values,
                color=draw.colour(i),
                marker=draw.marker(i),
                markersize=4,
                label=name,
            )
        said.append(
            "memory stalls of %s go from %s to %s %% between %d and %d primitives"
            % (name, number(stalled[0], 2), number(stalled[-1], 2), size[0], size[-1])
        )
    for axis, label in zip(
        axes[0], ("last-level misses per ray", "memory stall, % of modelled cycles")
    ):
        axis.set(xlabel="primitives (logarithmic)", ylabel=label, ylim=(0, None))
    draw.legend(figure, *axes[0][0].get_legend_handles_labels())
    caches = ordered(result.kernels.loc[result.kernels["simulated_by"] != "", "simulated_by"])
    return (
        Figure(
            "misses",
            draw.finish(figure, "misses"),
            "; ".join(said),
            "As the tree outgrows the caches, simulated (model:callgrind): %s."
            % "; ".join(caches[-1:]),
        ),
        said[-1],
    )


def section(results):
    blocks, missing, finding = [], [], []
    threads = results.first(lambda r: r.several_threads and len(r.timed()))
    if threads:
        figure, said = threads_figure(threads)
        blocks.append(figure)
        finding += said[:1]
    else:
        missing.append("Threads: give the folder of `raybench bench threads`, too.")
    sizes = results.first(lambda r: r.generated and curves(r))
    if sizes:
        figure, slopes = size_figure(sizes)
        blocks.append(figure)
        camera = [s for s in slopes if s[1:3] == ("trace", 0)]
        finding += [
            "a camera ray of %s takes %s ns more for each factor of ten in primitives, %s "
            "(R squared %s)" % (s[0], number(s[4]), s[3], number(s[5]))
            for s in camera[-1:]
        ]
    else:
        missing.append("Scene sizes: give the folder of `raybench bench scaling`, too.")
    missed = results.first(lambda r: r.generated and misses(r))
    if missed:
        figure, said = misses_figure(missed)
        blocks.append(figure)
        finding.append(said)
    else:
        missing.append(
            "Misses by scene size: give the folder of `raybench simulate scaling-sim`, too."
        )
    text = "; ".join(finding)
    return Section(
        "scaling",
        "More threads, more primitives",
        text[:1].upper() + text[1:] + "." if text else "Not measured.",
        blocks,
        missing,
    )
