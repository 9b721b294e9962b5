"""The report: one page that shows where the time goes, from result folders.

usage: scripts/report [-o FOLDER] [--raybench PROGRAM] [--table1 CSV] RESULT...

The first RESULT is what the report is about; the others add what is measured by itself: scaling,
threads, versus, peaks. FOLDER (report) gets report.html, which needs nothing else, report.md, and
the figures of the latter.
"""
import argparse
import datetime
import os
import sys

NEEDED = "python3-pandas python3-matplotlib python3-jinja2 python3-pil"
SECTIONS = [
    "verdict",
    "pictures",
    "times",
    "kernels",
    "categories",
    "energy",
    "movement",
    "scaling",
    "roofline",
    "samples",
    "pipeline",
    "machine",
]


def arguments():
    parser = argparse.ArgumentParser(prog="report", description=__doc__.split("\n\n")[0])
    parser.add_argument("results", nargs="+", metavar="RESULT", help="result folders")
    parser.add_argument("-o", dest="folder", default="report", help="where to write")
    parser.add_argument(
        "--raybench", default="build/raybench", help="draws scenes and trees of rays"
    )
    parser.add_argument("--table1", default="report/table1.csv", help="of `make table`")
    return parser.parse_args()


def write_all(folder, sections, title, made):
    import page

    figures = os.path.join(folder, "figures")
    os.makedirs(figures, exist_ok=True)
    stale = set(os.listdir(figures))
    for block in (b for s in sections for b in s.blocks):
        files = {
            "figure": lambda: [(block.name + ".svg", block.svg)],
            "pictures": lambda: [(name + ".png", png) for name, png, _, _ in block.items],
        }
        for name, content in files.get(block.kind, lambda: [])():
            page.write(os.path.join(figures, name), content)
            stale.discard(name)
    for name in stale:
        os.remove(os.path.join(figures, name))
    for template, name in (("report.html.j2", "report.html"), ("report.md.j2", "report.md")):
        page.write(
            os.path.join(folder, name),
            page.render(template, sections=sections, title=title, made=made),
        )


def main():
    given = arguments()
    try:
        import importlib

        modules = [importlib.import_module(name) for name in SECTIONS]
        from data import Results

        importlib.import_module("PIL")
    except ImportError as problem:
        sys.exit("report: %s; install it with: apt-get install %s" % (problem, NEEDED))
    results = Results(given.results, given.table1, given.raybench)
    if all(result.frames.empty for result in results.all):
        sys.exit(
            "report: %s: no frame.csv with any line; run make bench, or name a result folder"
            % " ".join(given.results)
        )
    made = "%s, commit %s, %s" % (
        results.main.fact("host", "cpu_model", default="unknown machine"),
        str(results.main.fact("git", "commit", default="unknown"))[:12],
        str(results.main.fact("started", default=""))[:10] or datetime.date.today().isoformat(),
    )
    try:
        write_all(given.folder, [m.section(results) for m in modules], "raybench", made)
    except OSError as problem:
        sys.exit("report: %s" % problem)
    print("%s: %d sections" % (os.path.join(given.folder, "report.html"), len(modules)))


main()
