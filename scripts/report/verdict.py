"""Section 1: who won, and by how much."""
import numpy

import draw
from data import number, ordered
from page import Figure, Section, Table

RAYS = ["primary", "shadow", "reflection", "refraction", "diffuse"]


def geometric_mean(values):
    values = [v for v in values if v == v and v > 0]
    return float(numpy.exp(numpy.mean(numpy.log(values)))) if values else float("nan")


def against_embree(versus):
    """{scene: geometric mean over classes of rays, one thread}"""
    one = versus[versus["threads"] == 1]
    return {
        scene: geometric_mean(one.loc[one["scene"] == scene, "ratio"])
        for scene in ordered(one["scene"])
    }


def line_of(result, scene, versus, paper):
    best, any_best = result.fastest(scene), result.fastest(scene, serial=False)
    naive = result.timed(scene)[result.timed(scene)["row"] == "naive"]
    if best is None:
        return None
    gain = naive["frame_ms"].iloc[0] / best["frame_ms"] if len(naive) else float("nan")
    return [
        scene,
        best["variant"],
        number(best["frame_ms"]),
        number(best["mrays_per_s"]),
        number(gain),
        number(versus.get(scene)),
        any_best["row"],
        number(any_best["frame_ms"]),
        number(paper.get(scene), 4),
    ]


def versus_figure(versus):
    """Ratios to Embree, every scene and class of rays, with their intervals."""
    one = versus[versus["threads"] == 1]
    scenes = ordered(one["scene"])
    figure, axes = draw.panels(1, 1, 8, 0.8 + 0.5 * len(scenes))
    axis = axes[0][0]
    for i, rays in enumerate(RAYS):
        rows = one[one["rays"] == rays]
        y = [scenes.index(s) + (i - 2) * 0.15 for s in rows["scene"]]
        spread = [rows["ratio"] - rows["ratio_lo"], rows["ratio_hi"] - rows["ratio"]]
        axis.errorbar(
            rows["ratio"],
            y,
            xerr=numpy.clip(spread, 0, None),
            fmt=draw.marker(i),
            color=draw.colour(i),
            label=rays,
            markersize=5,
            elinewidth=1,
        )
    axis.axvline(1, color=draw.INK, linewidth=1, linestyle="--")
    axis.set(
        yticks=range(len(scenes)),
        yticklabels=scenes,
        xlim=(0, None),
        xlabel="rays per second, ours over Embree's best mode (1: as fast); 95 % intervals",
    )
    axis.invert_yaxis()
    draw.legend(figure, *axis.get_legend_handles_labels(), columns=5)
    return Figure(
        "versus",
        draw.finish(figure, "versus"),
        "Ratios to Embree by scene and class of rays: "
        + "; ".join("%s %s %s" % (r.scene, r.rays, number(r.ratio)) for r in one.itertuples()),
        "Our best row against Embree's best mode, the same rays, one thread.",
    )


def total(table1):
    """Seconds of all scenes, the paper's and our best rows'; None where a scene has no time."""
    ours = table1[table1["median_s"].notna()].groupby("scene")["median_s"].min()
    paper = table1.groupby("scene")["paper_s"].first().dropna()
    if len(paper) == 0 or not set(paper.index) <= set(ours.index):
        return None
    return paper.sum(), ours[paper.index].sum()


def section(results):
    result, versus = results.main, against_embree(results.versus)
    paper = results.table1.groupby("scene")["paper_s"].first().dropna().to_dict()
    lines = [line_of(result, scene, versus, paper) for scene in result.scenes]
    lines = [line for line in lines if line]
    blocks, missing = [], []
    if lines:
        blocks.append(
            Table(
                [
                    "scene",
                    "fastest, one thread",
                    "ms a frame",
                    "Mrays/s",
                    "x naive",
                    "x Embree",
                    "fastest of all",
                    "ms a frame",
                    "paper, s",
                ],
                lines,
                "x Embree: geometric mean over classes of rays, `raybench versus`.",
            )
        )
        gains = [float(line[4]) for line in lines if line[4]]
        finding = "%s is the fastest row of one thread on most scenes%s." % (
            max(ordered(line[1] for line in lines), key=[line[1] for line in lines].count),
            ", up to %s times as fast as naive" % number(max(gains)) if gains else "",
        )
    else:
        finding = "Nothing was timed."
    if len(results.versus):
        blocks.append(versus_figure(results.versus))
        one = results.versus[results.versus["threads"] == 1]
        finding += (
            " Against Embree it wins %d of %d cells, by %s times in the geometric mean."
            % ((one["ratio"] > 1).sum(), len(one), number(geometric_mean(one["ratio"])))
        )
    else:
        missing.append(
            "Embree: no `versus.csv` in the folders given; `raybench versus` writes one."
        )
    sums = total(results.table1)
    if sums:
        finding += (
            " The six frames took the paper's machine %s s, ours %s s, whole processes."
            % (number(sums[0], 4), number(sums[1]))
        )
    else:
        missing.append(
            "The paper's Table 1 measured again: `make table` writes report/table1.csv."
        )
    return Section("verdict", "Verdict", finding, blocks, missing)
