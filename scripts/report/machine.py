"""Section 12: how to do it again."""
from data import number
from page import Code, Section, Table

FACTS = [
    ("processor", ("host", "cpu_model")),
    ("processors", ("cpu", "cpus")),
    ("system", ("host", "os")),
    ("kernel", ("host", "kernel")),
    ("hypervisor", ("host", "hypervisor")),
    ("memory, bytes", ("memory", "total_bytes")),
    ("huge pages", ("memory", "transparent_hugepage")),
    ("governor", ("frequency", "governor")),
    ("clock", ("clock", "source")),
    ("a probe, ns", ("clock", "probe_ns")),
    ("load at the start", ("load", "load_1m")),
    ("counters", ("counters", "pmu")),
    ("compiler", ("build", "compiler")),
    ("flags", ("build", "flags")),
    ("program, hash", ("binary", "hash")),
    ("commit", ("git", "commit")),
    ("uncommitted changes", ("git", "dirty")),
    ("started", ("started",)),
    ("seed", ("seed",)),
    ("pinning", ("pinning",)),
    ("schema of env.json", ("schema_version",)),
]


def said(result, path):
    value = result.fact(*path)
    if value is None:
        reason = result.fact("unreadable", ".".join(path))
        return "not known" + (": %s" % reason if reason else "")
    return number(value) if isinstance(value, float) else str(value)


def commands(results):
    lines = []
    for result in results.all:
        line = result.fact("command_line")
        if line:
            lines.append("%s   # %s" % (line, result.fact("session", default=result.folder)))
    return "\n".join(lines + [results.command])


def hashes(result):
    """What was rendered, and what every row had to give: of the image, of distances and ids."""
    rendered = result.frames[result.frames["image_hash"] != ""].drop_duplicates("scene")
    rendered = rendered.set_index("scene")[["image_hash", "hits_hash"]]
    lines = []
    for scene in result.env["scenes"]:
        given = rendered.loc[scene["name"]] if scene["name"] in rendered.index else ["", ""]
        lines.append([scene["name"], scene["hash"], str(scene["primitives"]), *given])
    return Table(
        ["scene", "hash of the file", "primitives", "of the image", "of all hits"], lines
    )


def section(results):
    result = results.main
    blocks, missing = [Code(commands(results))], []
    if result.env:
        blocks.append(
            Table(["what", "this run"], [[name, said(result, path)] for name, path in FACTS])
        )
    else:
        missing.append("The machine: the folder has no env.json.")
    if result.env.get("scenes"):
        blocks.append(hashes(result))
    checks = result.fact("doctor", "checks", default=[])
    warned = [c for c in checks if c.get("state") in ("warn", "bad")]
    if checks:
        blocks.append(
            Table(
                ["check", "state", "found", "why it matters", "what to do"],
                [
                    [
                        c.get("name"),
                        c.get("state"),
                        c.get("found"),
                        c.get("why"),
                        c.get("fix") or "",
                    ]
                    for c in checks
                ],
                "Findings of `raybench doctor`.",
                folded=True,
            )
        )
    schema = sorted(set(result.kernels["schema_version"].dropna().astype(int)))
    finding = (
        "Schema %s of kernels.csv; the doctor gives this machine %s of 100, warning of %s."
        % (
            ", ".join(map(str, schema)) or "unknown",
            said(result, ("doctor", "score")),
            ", ".join(c["name"] for c in warned) or "nothing",
        )
        if checks
        else "The machine is not known."
    )
    if result.env and not result.fact("complete", default=False):
        finding = "This run was stopped before its end. " + finding
    return Section("machine", "Doing it again", finding, blocks, missing)
