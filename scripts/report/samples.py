"""Section 10: raw samples, and comparisons with the noise."""
import numpy

import draw
from data import number, ordered
from page import Figure, Section


def strips(result, scene):
    """Every repetition of every row, and how they are distributed."""
    samples = result.samples[
        (result.samples["scene"] == scene) & (result.samples["kernel"] == "frame")
    ]
    ms = samples["wall_ns"].where(samples["wall_ns"].notna(), samples["ns"]) / 1e6
    order = ordered(result.frames.loc[result.frames["scene"] == scene, "row"])
    rows = [r for r in order if r != "naive" and (samples["row"] == r).any()]
    figure, (axes,) = draw.panels(1, 2, 4.2, 1 + 0.3 * len(rows))
    spread, chance = [], numpy.random.default_rng(0)
    for i, row in enumerate(rows):
        values = numpy.sort(ms[samples["row"] == row].dropna())
        if not len(values):
            continue
        axes[0].plot(
            values,
            i + chance.uniform(-0.3, 0.3, len(values)),
            "o",
            markersize=2.5,
            color=draw.colour(i),
            alpha=0.6,
        )
        share = numpy.arange(len(values) + 1) / len(values)
        axes[1].step(
            numpy.append(1, values / values[0]),
            share,
            where="post",
            color=draw.colour(i),
            label=row,
        )
        spread.append(
            "%s %d from %s to %s ms" % (row, len(values), number(values[0]), number(values[-1]))
        )
    axes[0].set(
        yticks=range(len(rows)),
        yticklabels=rows,
        xlabel="ms a frame (logarithmic)",
        xscale="log",
        title="%s, each repetition" % scene,
    )
    axes[0].minorticks_off()
    low, high = axes[0].get_xlim()
    axes[0].set_xticks(
        ticks := numpy.geomspace(low * 1.05, high / 1.05, 4), [number(t, 2) for t in ticks]
    )
    axes[0].invert_yaxis()
    axes[1].set(
        xlabel="times its least",
        ylabel="share of repetitions",
        ylim=(0, 1.02),
        title="distribution (ECDF)",
    )
    axes[1].set_xlim(1, min(2, axes[1].get_xlim()[1]))
    axes[1].legend(fontsize=7)
    name = "samples-" + scene
    return Figure(
        name, draw.finish(figure, name), "Repetitions on %s: %s" % (scene, "; ".join(spread))
    )


def comparisons(result):
    """[(what, ratio, low, high)]: each row over bvh; intervals of the two medians combined."""
    for scene in result.scenes:
        frames = result.timed(scene)
        base = frames[frames["row"] == "bvh"]
        if base.empty:
            continue
        base = base.iloc[0]
        for f in frames[~frames["variant"].isin(("naive", "bvh"))].itertuples():
            yield (
                "%s, %s" % (scene, f.row),
                f.frame_ms / base["frame_ms"],
                f.frame_ms_lo / base["frame_ms_hi"],
                f.frame_ms_hi / base["frame_ms_lo"],
            )


def forest(result):
    lines = list(comparisons(result))
    noise = result.timed()["mdape_pct"].median()
    figure, axes = draw.panels(1, 1, 7.5, 0.8 + 0.19 * len(lines))
    axis = axes[0][0]
    for i, (_, ratio, low, high) in enumerate(lines):
        axis.plot([low, high], [i, i], color=draw.colour(0), linewidth=1.5)
        axis.plot(ratio, i, draw.marker(0), color=draw.colour(0), markersize=4)
    axis.axvspan(1 - noise / 100, 1 + noise / 100, color=draw.FAINT, zorder=0)
    axis.axvline(1, color=draw.INK, linewidth=0.8)
    axis.set(
        yticks=range(len(lines)),
        yticklabels=[line[0] for line in lines],
        xlim=(0, None),
        xlabel="time of a frame over that of bvh; grey: noise, median deviation of %s %%"
        % number(noise, 2),
    )
    axis.tick_params(axis="y", labelsize=7)
    axis.invert_yaxis()
    clear = sum(high < 1 or low > 1 for _, _, low, high in lines)
    return Figure(
        "forest",
        draw.finish(figure, "forest"),
        "Time over bvh's: "
        + "; ".join(
            "%s %s (%s to %s)" % (w, number(r), number(lo), number(hi)) for w, r, lo, hi in lines
        ),
        "Comparisons within the run; an interval that leaves the grey band is a difference.",
    ), (clear, len(lines), noise)


def section(results):
    result, blocks, missing = results.main, [], []
    finding = "There are no repetitions to show."
    if len(result.samples):
        blocks = [
            strips(result, scene)
            for scene in result.scenes
            if (result.samples["scene"] == scene).any()
        ]
        finding = (
            "%d repetitions of frames are shown." % (result.samples["kernel"] == "frame").sum()
        )
    else:
        missing.append("Repetitions: the folder has no samples.csv.")
    if any(True for _ in comparisons(result)):
        figure, (clear, count, noise) = forest(result)
        blocks.append(figure)
        finding = (
            "The intervals of %d of %d comparisons with bvh are clear of 1; a repetition is off "
            "its median by %s %%, typically." % (clear, count, number(noise, 2))
        )
    return Section(
        "samples", "Raw samples, and how sure comparisons are", finding, blocks, missing
    )
