"""Section 9: each kernel against what this machine gets through at most.

The roofline of Williams, Waterman and Patterson (2009), with instructions for operations (Ding and
Williams 2019): instructions per ns over instructions per byte that has to come from beyond L1.
Instructions and misses are simulated, times measured, and the roofs are `raybench peaks`.
"""
import draw
from data import KERNELS, number, ordered
from page import Figure, Section

LINE_BYTES = 64


def points(result, variants):
    """[(variant, kernel, bounce, instructions per byte, per ns)] over all scenes"""
    k = result.kernels[
        result.kernels["kernel"].isin(KERNELS)
        & result.kernels["bounce"].notna()
        & result.kernels["ns_per_ray"].notna()
        & result.kernels["instructions_per_ray"].notna()
    ]
    for place in k[k["variant"].isin(variants)].itertuples():
        moved = place.l1d_misses_per_ray * LINE_BYTES
        if moved > 0 and place.ns_per_ray > 0:
            yield (
                place.variant,
                place.kernel,
                place.scene,
                int(place.bounce),
                place.instructions_per_ray / moved,
                place.instructions_per_ray / place.ns_per_ray,
            )


def figure_of(shown, peaks, most):
    figure, axes = draw.panels(1, 1, 7.5, 4.2)
    axis = axes[0][0]
    variants = list(dict.fromkeys(p[0] for p in shown))
    for v, variant in enumerate(variants):
        for k, kernel in enumerate(KERNELS):
            some = [p for p in shown if p[:2] == (variant, kernel)]
            if some:
                axis.loglog(
                    [p[4] for p in some],
                    [p[5] for p in some],
                    draw.marker(k),
                    alpha=0.7,
                    color=draw.colour(v),
                    markersize=5,
                    label="%s, %s" % (variant, kernel),
                )
    low = min(p[5] for p in shown) / 2
    last = max(max(p[4] for p in shown), most / min(peaks.values())) * 2
    for i, (level, per_ns) in enumerate(peaks.items()):
        axis.plot([low / per_ns, most / per_ns], [low, most], color=draw.INK, linewidth=0.8)
        at = low * 1.5 ** (1 + 2 * i)
        axis.annotate(
            "%s: %s bytes a ns" % (level, number(per_ns)),
            (at / per_ns, at),
            (4, 0),
            textcoords="offset points",
            fontsize=7,
            va="center",
        )
    axis.plot([most / max(peaks.values()), last], [most, most], color=draw.INK, linewidth=0.8)
    axis.text(
        last, most, "%s instructions a ns" % number(most), fontsize=7, ha="right", va="bottom"
    )
    axis.set(
        xlabel="instructions per byte from beyond L1 (simulated, logarithmic)",
        ylabel="instructions per ns (logarithmic)",
    )
    draw.legend(figure, *axis.get_legend_handles_labels())
    near = max(shown, key=lambda p: p[5])
    return Figure(
        "roofline",
        draw.finish(figure, "roofline"),
        "Roofline: %d kernels at bounces. The nearest to the roof of %s instructions a ns: "
        "%s of %s at bounce %d on %s, %s."
        % (len(shown), number(most), near[1], near[0], near[3], near[2], number(near[5])),
        "A dot is a kernel at a bounce on a scene. Roofs: bytes from L2, L3 and memory, "
        "instructions of the best loop of additions.",
    )


def section(results):
    result = results.main
    title = "Against the peak of this machine"
    measured = results.first(lambda r: len(r.peaks))
    cpu = result.fact("host", "cpu_model", default="")
    if not measured:
        return Section(
            "roofline",
            title,
            "The peaks of this machine were not measured.",
            [],
            ["Roofs: `raybench peaks RESULT` measures them, on the machine of the result."],
        )
    peaks = measured.peaks.set_index("peak")["per_ns"]
    if cpu and measured.peaks["cpu_model"].iloc[0] != cpu:
        return Section(
            "roofline",
            title,
            "The peaks are another machine's.",
            [],
            [
                "Roofs: they are of %s, the result is of %s."
                % (measured.peaks["cpu_model"].iloc[0], cpu)
            ],
        )
    variants = [
        v for v in ordered(result.frames["variant"]) if v != "naive" and not v.endswith("+omp")
    ]
    shown = list(points(result, variants))
    if not shown:
        return Section(
            "roofline",
            title,
            "No kernel has both a time and simulated instructions.",
            [],
            ["Instructions: `raybench bench report` asks a simulator; it needs valgrind."],
        )
    most = peaks.get("instructions", float("nan"))
    levels = {k: v for k, v in peaks.items() if k not in ("cycles", "instructions", "L1")}
    shares = {}
    for p in shown:
        if p[1] == "trace":
            shares.setdefault(p[0], []).append(100 * p[5] / most)
    finding = "Tracing gets through %s of the most instructions this machine can." % "; ".join(
        "%s to %s %% (%s)" % (number(min(s), 2), number(max(s), 2), v) for v, s in shares.items()
    )
    return Section(
        "roofline",
        title,
        finding,
        [figure_of(shown, levels, most)],
        [
            "Ports and stalls: no counters here, so a dot says how far a kernel is from the roof, "
            "not why."
        ]
        if result.fact("counters", "pmu") == "none"
        else [],
    )
