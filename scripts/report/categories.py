"""Section 5: compute, compute stall, memory stall, other."""
import draw
from data import CATEGORIES, KERNELS, number, ordered
from page import Figure, Section

SHORT = {"generate": "g", "trace": "t", "shade": "s", "trace_shadow": "ts"}


def panel(axis, places):
    """A bar for each kernel and bounce: solid where hardware counted, hatched where a simulator
    did, none where nobody did."""
    places = places.sort_values(
        "kernel", key=lambda names: names.map(KERNELS.index), kind="stable"
    )
    labels = ["%s%d" % (SHORT[p.kernel], p.bounce) for p in places.itertuples()]
    modelled = [source.startswith("model") for source in places["category_source"]]
    base = [0.0] * len(places)
    for i, category in enumerate(CATEGORIES):
        values = places[category + "_pct"].fillna(0).tolist()
        bars = axis.bar(
            labels,
            values,
            bottom=base,
            color=draw.colour(i),
            label=category.replace("_", " "),
            edgecolor=draw.PAPER,
            linewidth=0.3,
        )
        for bar, hatched in zip(bars, modelled):
            bar.set_hatch(draw.HATCH if hatched else None)
        base = [a + b for a, b in zip(base, values)]
    axis.set(ylim=(0, 100))
    axis.tick_params(axis="x", labelsize=6, rotation=90)


def figure_of(result, scene, variants):
    name = "categories-" + scene
    figure, axes = draw.grid(len(variants), 3, 3.4, 2.2)
    for axis, variant in zip(axes, variants):
        panel(axis, result.places(scene, variant))
        axis.set_title("%s, %s" % (scene, variant))
        axis.set_ylabel("percent of cycles")
    draw.legend(figure, *axes[0].get_legend_handles_labels())
    said = []
    for variant in variants:
        trace = result.grid(scene, variant, "memory_stall_pct").loc["trace"].dropna()
        said += (
            [
                "%s: memory stall of trace %s to %s %%"
                % (variant, number(trace.min()), number(trace.max()))
            ]
            if len(trace)
            else []
        )
    return Figure(
        name, draw.finish(figure, name), "Categories on %s. %s" % (scene, "; ".join(said))
    )


def section(results):
    result, blocks = results.main, []
    known = result.kernels[result.kernels[[c + "_pct" for c in CATEGORIES]].notna().any(axis=1)]
    sources = sorted(set(known["category_source"]) - {""})
    pmu = result.fact("counters", "pmu")
    missing = [
        "By hardware: %s: %s." % (note, ", ".join(ordered(rows["row"])))
        for note, rows in result.kernels.groupby("hardware_note")
        if note
    ]
    if not any(source.startswith("pmu") for source in sources):
        missing.append(
            "By hardware: not measured%s. The same run on a machine that has them, with "
            "`--measure hardware`, draws solid bars."
            % ("; this machine has no counters" if pmu == "none" else "")
        )
    if known.empty:
        missing.append("By simulation: `raybench bench report` asks for it; it needs valgrind.")
        return Section("categories", "The four categories", "Nobody counted.", [], missing)
    for scene in result.scenes:
        rows = [
            v
            for v in result.serial_rows(scene)
            if v in set(known.loc[known["scene"] == scene, "variant"])
        ]
        if rows:
            blocks.append(figure_of(result, scene, rows))
    if any(source.startswith("model") for source in sources):
        missing.append(
            "Compute stalls of hatched bars: the simulated processor has none; and it "
            "has no prefetcher, no second level and no TLB, so trust differences, not levels."
        )
    places = known[known["bounce"].notna() & known["kernel"].isin(("trace", "trace_shadow"))]
    worst = (
        places.loc[places["memory_stall_pct"].idxmax()]
        if places["memory_stall_pct"].notna().any()
        else None
    )
    finding = (
        "Hatched: modelled from simulated events; solid: counted by hardware (%s)."
        % ", ".join(sources)
    )
    if worst is not None:
        finding = (
            "Waiting for memory is at most %s %% of what a ray takes: %s at bounce %d of %s, %s "
            "(%s)."
            % (
                number(worst["memory_stall_pct"]),
                worst["kernel"],
                worst["bounce"],
                worst["scene"],
                worst["variant"],
                worst["category_source"],
            )
        )
    return Section(
        "categories", "Compute, compute stall, memory stall, other", finding, blocks, missing
    )
