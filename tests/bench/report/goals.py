"""What the figures shall reach: lines of what, figure, <= or >=, goal (None: the figure is for reading), unit."""

TOTAL_MS = {("Vetebrae", 8): 250, ("Vetebrae", 9): 1000, ("Abdomen", 8): 600}
OTHER_TOTAL_MS = 250
LAST_THIRD_P95_MS = 33
DELAUNAY_SET, DELAUNAY_RATIO = "Vetebrae", 20
FIELD_RATE = {500: 1.0e9, 40: 0.6e9}  # edges a cell: edge evaluations/s/core
ANGLE_P5_DEG = 25
CONTOUR_CELLS = {"p50": 0.02, "p95": 0.25}
LABELS_RATIO = 2
MEMORY_AT_200_MIB, SLICE_AT_200_RATIO = 2048, 3


def total_goal(record):
    return TOTAL_MS.get((record["set"], record["depth"]), OTHER_TOTAL_MS)


def of_bench(records, bench):
    return [r for r in records if r["bench"] == bench]


def curve(records, name):
    return [r for r in of_bench(records, "scaling") if r["curve"] == name]


def slice_cost(points, n):
    """Median ms of the 25 slices up to the n-th."""
    costs = sorted(p["total_ms"] for p in points if n - 25 < p["x"] <= n)
    return costs[len(costs) // 2]


def labels_ratio(points):
    cost = {p["x"]: p["total_ms"] for p in points}
    return cost[32] / cost[2]


def set_goals(record):
    name = f"{record['set']}, depth {record['depth']}"
    yield f"{name}: total, 2 threads", record["runs"][-1]["total_ms"], "<=", total_goal(record), "ms"
    for key, detail in (("online", "full detail"), ("online_live", "as live")):
        if record[key]:
            yield f"{name}: slice by slice, {detail}, last third, p95", record[key]["last_third_p95_ms"], "<=", \
                LAST_THIRD_P95_MS, "ms"


def quality_goals(record):
    name = f"{record['set']}, depth {record['depth']}"
    yield f"{name}: smallest angle, p5", record["smallest_angle_p5_deg"], ">=", ANGLE_P5_DEG, "deg"
    for q, goal in CONTOUR_CELLS.items():
        yield f"{name}: contour to mesh, {q}", record[f"contour_distance_{q}_cells"], "<=", goal, "cells"
    for key, what in (("manifold_faults", "faults of closed manifolds"), ("degenerate_triangles", "degenerate triangles"),
                      ("self_intersections", "self-intersections")):
        yield f"{name}: {what}", record[key], "<=", 0, ""


def field_goals(records):
    opencl = [r for r in of_bench(records, "field") if r["device"] == "opencl"]
    for edges, goal in FIELD_RATE.items():
        if opencl:
            nearest = min(opencl, key=lambda r: abs(r["edges_a_cell"] - edges))
            yield f"field with OpenCL, {nearest['edges_a_cell']:.0f} edges a cell", \
                nearest["edge_evaluations_per_s_core"] * 1e-9, ">=", goal * 1e-9, "G edge evaluations/s/core"


def scaling_goals(records):
    slices = curve(records, "slices")
    for name, points in (("free planes", slices), ("a parallel stack", curve(records, "stack"))):
        yield f"cost of a slice of {name} at 200 slices over that at 50", slice_cost(points, 200) / slice_cost(points, 50), \
            "<=", SLICE_AT_200_RATIO, ""
    yield "peak memory at 200 slices", slices[-1]["peak_memory_mib"], "<=", MEMORY_AT_200_MIB, "MiB"
    for name in ("labels apart", "labels touching"):
        yield f"{name}: time with 32 over that with 2", labels_ratio(curve(records, name)), "<=", LABELS_RATIO, ""


def of_all_sets(records):
    for record in of_bench(records, "set"):
        yield from set_goals(record)
    for record in of_bench(records, "quality"):
        yield from quality_goals(record)


def quality_of_both(record):
    for what in ("live", "delaunay"):
        quality, name = record[f"{what}_quality"], f"{record['set']}, {what} mesh"
        for key, figure in (("smallest_angle_p5_deg", "smallest angle, p5"), ("smallest_angle_p50_deg", "smallest angle, p50")):
            yield f"{name}: {figure}", quality[key], "", None, "deg"
        for key, figure in (("to_zero_set_p50_cells", "distance to the zero set, p50"), ("to_zero_set_p99_cells", "distance to the zero set, p99"),
                            ("hausdorff_cells", "Hausdorff distance to the zero set")):
            yield f"{name}: {figure}", quality[key], "", None, "cells"


def of_programs(records):
    for record in of_bench(records, "delaunay"):
        if record["set"] == DELAUNAY_SET:
            yield f"{record['set']}: Delaunay mesh over live mesh", record["ratio"], ">=", DELAUNAY_RATIO, ""
            yield from quality_of_both(record)
    yield from field_goals(records)
    yield from scaling_goals(records)


def reached(figure, sense, goal):
    """None where there is no goal."""
    if goal is None:
        return None
    if figure is None:
        return False
    return figure <= goal if sense == "<=" else figure >= goal
