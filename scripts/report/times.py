"""Section 3: the render-time table."""
from data import number, ordered
from page import Section, Table


def interval(frame):
    return (
        ""
        if frame.frame_ms_lo != frame.frame_ms_lo
        else "%s to %s" % (number(frame.frame_ms_lo), number(frame.frame_ms_hi))
    )


def image_check(frame, truth):
    if "invalid" in frame.flags or "invalid" in frame.note:
        return "DIFFERS"
    if "inexact" in frame.flags:
        return "not held to it"
    if "estimated" in frame.flags:
        return "same, by groups of tiles"
    if not frame.image_hash:
        return "not rendered in full"
    return "same" if frame.image_hash == truth else "DIFFERS"


def frame_table(result):
    lines = []
    for scene in result.scenes:
        frames = result.frames[result.frames["scene"] == scene]
        hashes = [
            h for h, f in zip(frames["image_hash"], frames["flags"]) if h and "inexact" not in f
        ]
        truth = max(hashes, key=hashes.count) if hashes else ""
        naive = frames.loc[frames["row"] == "naive", "frame_ms"]
        for frame in frames.itertuples():
            gain = naive.iloc[0] / frame.frame_ms if len(naive) else float("nan")
            lines.append(
                [
                    scene,
                    frame.row,
                    number(frame.frame_ms, 4),
                    interval(frame),
                    number(frame.mrays_per_s),
                    number(gain),
                    image_check(frame, truth),
                    (frame.flags or frame.note).replace(";", ", "),
                ]
            )
    return lines


def paper_table(table1):
    """Seconds of whole processes: scenes by rows, the paper's first."""
    scenes = ordered(table1["scene"])
    lines = [
        ["the paper (another machine, 2019)"]
        + [number(table1.loc[table1["scene"] == s, "paper_s"].iloc[0], 4) for s in scenes]
    ]
    for variant in ordered(table1["variant"]):
        seconds = table1[table1["variant"] == variant].set_index("scene")["median_s"]
        lines.append([variant] + [number(seconds.get(s)) for s in scenes])
    return Table(
        ["seconds"] + scenes,
        lines,
        "Table 1 of the paper measured again: whole processes, from start to image file, "
        "medians, `make table`.",
    )


def section(results):
    result, blocks, missing = results.main, [], []
    lines = frame_table(result)
    wrong = [line for line in lines if line[6] == "DIFFERS"]
    timed = result.timed()
    if len(results.table1):
        blocks.append(paper_table(results.table1))
    else:
        missing.append("The paper's table: no report/table1.csv; `make table` writes it.")
    if lines:
        blocks.append(
            Table(
                [
                    "scene",
                    "row",
                    "ms a frame",
                    "95 % interval",
                    "Mrays/s",
                    "x naive",
                    "image",
                    "flags",
                ],
                lines,
                "Frames, medians over processes.",
                folded=len(lines) > 20,
            )
        )
    finding = "Nothing was timed."
    if len(timed):
        rows = timed[timed["variant"] != "naive"]["mrays_per_s"]
        finding = "%d of %d cells have a time, from %s to %s Mrays/s without naive, and %s." % (
            len(timed),
            len(result.frames),
            number(rows.min()),
            number(rows.max()),
            "%d images DIFFER from the reference" % len(wrong)
            if wrong
            else "no image differs from the reference by a bit",
        )
    untimed = result.frames[result.frames["frame_ms"].isna()]
    missing += [
        "%s: %s." % (", ".join(ordered(rows["row"])), note or "no time")
        for note, rows in untimed.groupby("note")
    ]
    if result.unavailable:
        missing.append("%s: this machine cannot run them." % ", ".join(result.unavailable))
    return Section("times", "Render times", finding, blocks, missing)
