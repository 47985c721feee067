"""The methods of docs/methods.md, the live one beside them: one table of how good they are and what they cost."""
import pathlib

METHODS = ("live", "metamorphosis", "equal-importance", "medial-axis", "straight-skeleton")
DEPTH = 8
TRUTHS = {"eight_15": "eight_20_scaled", "eight_20": "eight_20_scaled", "hand_ok": "hand_ok_scaled"}
PAGE = pathlib.Path("docs/methods.md")
BEGIN, END = "<!-- figures: begin -->\n", "<!-- figures: end -->"

HEADS = [["set", "method", "IoU", "mean", "max", "contour", "contour", "closed", "triangles", "time", "peak"],
         ["", "", "", "%", "%", "p95", "max", "", "", "s", "MiB"]]


def measure(run, sets):
    """@param run  calls a program, and gives its figures"""
    records = []
    files = [*sets.glob("*.csl"), *(sets.parent / "contour").glob("*.contour")]
    for path in sorted(files, key=lambda p: p.stem.lower()) + ["pelvis"]:
        name = getattr(path, "stem", path)
        truth = [sets.parent / "truth" / f"{TRUTHS[name]}.stl"] if name in TRUTHS else []
        for method in METHODS:
            records += run("bench_methods", path, DEPTH, method, *truth)
    return records


def cells(record):
    def number(key, digits):
        return f"{record[key]:.{digits}f}" if key in record else ""

    if "refused" in record:
        return [record["set"], record["method"], "does not take it"] + [""] * 8
    return [record["set"], record["method"], number("iou", 4), number("mean_percent", 3), number("max_percent", 2),
            number("contour_p95_cells", 3), number("contour_max_cells", 2), closed(record),
            str(record["triangles"]), f"{record['ms'] / 1000:.2f}", number("peak_memory_mib", 0)]


def closed(record):
    return "yes" if record["manifold"] else "pinched" if record["closed"] else "NO"


def text(records):
    lines = HEADS + [cells(record) for record in records]
    widths = [max(len(line[i]) for line in lines if "take" not in line[i]) for i in range(len(HEADS[0]))]
    return "\n".join("  ".join(c.rjust(w) if i > 1 and "take" not in c else c.ljust(w)
                               for i, (c, w) in enumerate(zip(line, widths))).rstrip() for line in lines)


def write_page(words):
    before, rest = PAGE.read_text().split(BEGIN)
    PAGE.write_text(f"{before}{BEGIN}```\n{words}\n```\n{END}{rest.split(END)[1]}")
