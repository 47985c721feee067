"""The table of all recorded sets, and the goals."""
import goals

STAGES = ("cells", "field", "octree", "smooth", "mesh")


def number(value, digits=3):
    """Three digits that count, no exponent."""
    if value is None:
        return "-"
    if isinstance(value, int) or abs(value) >= 100:
        return f"{value:.0f}"
    return f"{value:.{digits}g}"


def time_cells(record, run):
    rate = record["edge_evaluations"] / run["field_ms"] * 1e-6
    stages = [number(run[f"{stage}_ms"]) for stage in STAGES]
    return [record["set"], str(record["depth"]), str(run["threads"]), number(run["total_ms"]),
            str(goals.total_goal(record)), *stages, number(rate)]


def online_cells(record):
    full = record["online"] or {}
    live = record["online_live"] or {}
    keys = ("p50_ms", "p95_ms", "last_third_p50_ms", "last_third_p95_ms")
    return [number(full.get(k)) for k in keys] + [number(live.get("last_third_p95_ms")),
                                             "/".join(map(str, live.get("last_third_drawn", "-")))]


def quality_cells(quality):
    faults = quality["manifold_faults"] + quality["degenerate_triangles"]
    keys = ("smallest_angle_p5_deg", "smallest_angle_p50_deg", "contour_distance_p50_cells",
            "contour_distance_p95_cells")
    return [number(quality[k]) for k in keys] + [str(faults), number(quality["self_intersections"])]


HEADS = [["set", "d", "t", "total", "goal", *STAGES, "field", "all", "all", "last", "last", "live", "live",
          "peak", "Delaunay", "over", "angle", "angle", "contour", "contour", "not", "cross"],
         ["", "", "", "ms", "ms", *("ms" for _ in STAGES), "Gee/s", "p50", "p95", "p50", "p95", "p95", "f/c/d",
          "MiB", "s", "live", "p5", "p50", "p50", "p95", "manif.", "ing"],
         ["goal", "", "", "", "", *("" for _ in STAGES), "", "", "", "", f"{goals.LAST_THIRD_P95_MS}",
          f"{goals.LAST_THIRD_P95_MS}", "", "", "", f"{goals.DELAUNAY_RATIO}", f"{goals.ANGLE_P5_DEG}", "",
          f"{goals.CONTOUR_CELLS['p50']}", f"{goals.CONTOUR_CELLS['p95']}", "0", "0"]]


def rows(records):
    def other(bench, record):
        same = [r for r in goals.of_bench(records, bench) if (r["set"], r["depth"]) == (record["set"], record["depth"])]
        return same[0] if same else None

    for record in goals.of_bench(records, "set"):
        delaunay = other("delaunay", record)
        rest = online_cells(record) + [number(record["peak_memory_mib"])]
        rest += [number(delaunay["delaunay_ms"] * 1e-3), number(delaunay["ratio"])] if delaunay else ["-", "-"]
        rest += quality_cells(other("quality", record))
        for run in record["runs"][:-1]:
            yield time_cells(record, run) + [""] * len(rest)
        yield time_cells(record, record["runs"][-1]) + rest


def sets_text(records):
    lines = HEADS + list(rows(records))
    widths = [max(len(line[i]) for line in lines) for i in range(len(lines[0]))]
    return "\n".join("  ".join(cell.rjust(w) if i else cell.ljust(w) for i, (cell, w) in enumerate(zip(line, widths)))
                     .rstrip() for line in lines)


def slices_text(records):
    """What each slice of one set costs: no work on all that is there hides in it."""
    found = [r for r in goals.of_bench(records, "set") if (r["set"], r["depth"]) == ("Vetebrae", 8)]
    if not found:
        return ""
    lines = ["Vetebrae, depth 8, slice by slice at full detail: ms, cells cut, samples, bricks smoothed, chunks rebuilt"]
    for i, cost in enumerate(found[0]["online"]["slices"]):
        lines.append(f"{i + 1:4}{cost['ms']:8.1f}{cost['cells_cut']:6}{cost['samples']:9}{cost['bricks_smoothed']:7}"
                     f"{cost['chunks_rebuilt']:7}")
    return "\n".join(lines) + "\n\n"


def goal_line(what, figure, sense, goal, unit):
    state = {True: "reached", False: "MISSED", None: ""}[goals.reached(figure, sense, goal)]
    aim = f"{sense} {number(goal)}" if goal is not None else ""
    return f"{state:8}{what:72}{number(figure):>8} {aim:8} {unit}".rstrip()


def goals_text(records):
    """Of the recorded sets those that are missed: there are too many to list, and the table has them all."""
    of_sets = list(goals.of_all_sets(records))
    missed = [line for line in of_sets if not goals.reached(line[1], line[2], line[3])]
    lines = [f"Recorded sets: {len(of_sets) - len(missed)} of {len(of_sets)} goals reached."]
    return "\n".join(lines + [goal_line(*line) for line in missed + list(goals.of_programs(records))])


def machine_text(machine):
    text = f"{machine['cpu']}, {machine['cores']} cores, {machine['vectors']}"
    if machine["busy_share"] > 0.1:
        text += f"; {machine['busy_share']:.0%} busy with other work: times are too long"
    return text


def text(result):
    records = result["records"]
    took = f"All of it took {result['seconds'] / 60:.0f} minutes."
    return f"{machine_text(result['machine'])}\n\n{sets_text(records)}\n\n{slices_text(records)}{goals_text(records)}\n\n{took}"
