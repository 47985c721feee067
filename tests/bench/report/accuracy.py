"""How near meshes come to what their slices were cut from, with either field: the tables of docs/accuracy.md."""
import pathlib

DEPTH = 7
FIELDS = ("step", "smooth")
PAGE = pathlib.Path("docs/accuracy.md")
BEGIN, END = "<!-- figures: begin -->\n", "<!-- figures: end -->"

#: What is shown of a record for each field: heading, key, digits
FIGURES = [("IoU", "iou", 4), ("wrong %", "mislabelled", 2), ("mean %", "mean_percent", 3), ("max %", "hausdorff_percent", 2),
           ("large", "large_pieces", 0), ("genus", "genus", 0), ("crease", "crease_deg", 1), ("lean", "lean_deg", 1)]


def number(record, key, digits):
    """Counts have no decimals, their means one."""
    value = (100 if key == "mislabelled" else 1) * record[key]
    return f"{value:.{digits or (0 if value == int(value) else 1)}f}"


def mean_of(records):
    keys = [key for _, key, _ in FIGURES] + ["truth_large_pieces", "truth_genus"]
    return {key: sum(r[key] for r in records) / len(records) for key in keys}


def by_field(records, **wanted):
    """Pairs (step, smooth) of the records with these values, in the order they were measured."""
    chosen = [r for r in records if all(r[key] == value for key, value in wanted.items())]
    smooth = {name(r): r for r in chosen if r["field"] == "smooth"}
    return [(r, smooth[name(r)]) for r in chosen if r["field"] == "step"]


def name(record):
    return tuple(record[key] for key in ("group", "set", "planes", "count", "noise_percent", "seed"))


def row(head, step, smooth):
    return head + [f"{number(step, key, digits)} → {number(smooth, key, digits)}" for _, key, digits in FIGURES] + \
        [f"{number(step, 'truth_large_pieces', 0)}, {number(step, 'truth_genus', 0)}"]


def markdown(heads, rows):
    heads = heads + [head for head, _, _ in FIGURES] + ["truth"]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in [heads, ["---"] * len(heads)] + rows)


def table_of(pairs):
    """A line for each set, one plane set and one noise, and their means."""
    rows = [row([step["set"], f"{step['count']} {step['planes']}"], step, smooth) for step, smooth in pairs]
    return markdown(["set", "planes"], rows + [row(["**mean**", ""], *mean_pair(pairs))])


def means_over(records, group, key, values, **wanted):
    """A line for each value of a key: the mean over all sets of a group."""
    rows = []
    for value in values:
        pairs = by_field(records, group=group, **{key: value}, **wanted)
        if pairs:
            rows.append(row([f"{value:g}" if key == "noise_percent" else str(value), str(len(pairs))], *mean_pair(pairs)))
    return markdown([key.replace("_percent", ", %"), "cases"], rows)


def values_of(records, key, **wanted):
    return list(dict.fromkeys(r[key] for r in records if all(r[k] == v for k, v in wanted.items())))


def mean_pair(pairs):
    """One pair out of several: its first's names, the means of their figures."""
    return tuple({**pairs[0][i], **mean_of([pair[i] for pair in pairs])} for i in range(2))


def one_each(records, noise):
    """Recorded sets, and meshes at 20 planes: the means over the sets of planes."""
    pairs = by_field(records, group="recorded", noise_percent=noise)
    for mesh in values_of(records, "set", group="meshes"):
        of_mesh = by_field(records, group="meshes", set=mesh, noise_percent=noise, count=20)
        pairs += [mean_pair(of_mesh)] if of_mesh else []
    return pairs


#: How meshes pass through their slices: heading, key
PASSAGE = [("turn", "turn_deg"), ("lower quarter", "turn_quarter_deg"), ("median", "turn_median_deg"),
           ("upper quarter", "turn_three_quarters_deg"), ("along", "along_deg")]


def passages(pairs):
    """A line for each set: how far its meshes and its truth turn across slices and along them."""
    heads = ["set", "planes"] + [head for head, _ in PASSAGE] + ["truth: turn", "truth: along"]
    rows = [[step["set"], f"{step['count']} {step['planes']}"] +
            [f"{step[key]:.1f} → {smooth[key]:.1f}" for _, key in PASSAGE] +
            [f"{smooth['truth_turn_deg']:.1f}", f"{smooth['truth_along_deg']:.1f}"] for step, smooth in pairs]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in [heads, ["---"] * len(heads)] + rows)


def sections(records):
    for noise in (0, 0.5):
        pairs = one_each(records, noise)
        if pairs:
            yield f"**Recorded sets and meshes (these: means over three sets of planes), noise {noise} %**", table_of(pairs)
    for group, key, wanted, what in (
            ("recorded", "noise_percent", {}, "Recorded sets over noise"),
            ("meshes", "noise_percent", {"count": 20}, "Meshes at 20 planes, three sets of them each, over noise"),
            ("meshes", "count", {"set": "camel", "noise_percent": 0}, "camel over planes, three sets of them each"),
            ("meshes", "count", {"set": "femur", "noise_percent": 0}, "femur over planes, three sets of them each"),
            ("bodies", "planes", {"count": 20}, "Bodies of one label, 20 planes, over kinds of planes"),
            ("bodies", "set", {"count": 20}, "Bodies of one label, 20 planes, over bodies"),
            ("bodies", "count", {"planes": "random"}, "Bodies of one label over random planes")):
        values = sorted(values_of(records, key, group=group, **wanted)) if key in ("noise_percent", "count") else \
            values_of(records, key, group=group, **wanted)
        if values:
            yield f"**{what}**", means_over(records, group, key, values, **wanted)
    images = by_field(records, group="images")
    if images:
        yield "**The demo's liver, three labels**", table_of(images)
        yield "**Degrees that surfaces turn across slices, and along them over as long a way, noise 0 %**", \
            passages(by_field(records, group="recorded", noise_percent=0) + images +
                     by_field(records, group="meshes", noise_percent=0, count=20, seed=1))
    for noise in values_of(records, "noise_percent", group="junctions"):
        yield f"**The body of three labels, noise {noise:g} %**", \
            table_of(by_field(records, group="junctions", noise_percent=noise))


def text(records):
    return "\n\n".join(f"{head}\n\n{table}" for head, table in sections(records))


def write_page(records):
    before, rest = PAGE.read_text().split(BEGIN)
    PAGE.write_text(f"{before}{BEGIN}\n{text(records)}\n\n{END}{rest.split(END)[1]}")
