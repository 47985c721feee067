"""Draws the curves of build/release/bench.json into docs/bench and puts the table into its page."""
import pathlib

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

import goals
import table

FOLDER = pathlib.Path("docs/bench")
PAGE = FOLDER / "README.md"
BEGIN, END = "<!-- figures: begin -->\n", "<!-- figures: end -->\n"
STAGES = [("cells", "#7f7f7f"), ("field", "#d62728"), ("octree", "#2ca02c"), ("smooth", "#9467bd"), ("mesh", "#1f77b4")]

plt.rcParams.update({"svg.hashsalt": "sonoloft", "font.size": 10, "axes.grid": True, "grid.color": "#e0e0e0",
                     "axes.axisbelow": True, "axes.spines.top": False, "axes.spines.right": False,
                     "legend.frameon": False, "figure.facecolor": "white"})


def save(figure, name):
    figure.tight_layout()
    figure.savefig(FOLDER / f"{name}.svg", metadata={"Date": None})
    plt.close(figure)


def goal_line(axes, value, text):
    axes.axhline(value, color="black", linestyle="--", linewidth=1)
    axes.annotate(text, (0.02, value), xycoords=("axes fraction", "data"), xytext=(0, 3), textcoords="offset points")


def stage_lines(axes, points):
    x = [p["x"] for p in points]
    axes.plot(x, [p["total_ms"] for p in points], "o-", color="black", linewidth=2, label="total")
    for stage, colour in STAGES:
        axes.plot(x, [p[f"{stage}_ms"] for p in points], "o-", color=colour, markersize=4, label=stage)


def slices(points):
    figure, (cost, memory) = plt.subplots(1, 2, figsize=(10, 4))
    x = [p["x"] for p in points]
    cost.plot(x, [p["total_ms"] for p in points], ".", color="#b0b0b0", label="one slice")
    for name, colour in [("total", "black")] + STAGES:
        middle = [sorted(p[f"{name}_ms"] for p in points[max(0, i - 24):i + 1]) for i in range(len(points))]
        cost.plot(x[24:], [m[len(m) // 2] for m in middle[24:]], color=colour, label=f"{name}, median of last 25")
    cost.set(xlabel="slices inserted", ylabel="time for one more slice (ms)", ylim=(0, None))
    cost.set_title(f"at 200 slices {goals.slice_cost(points, 200) / goals.slice_cost(points, 50):.2f} times that at 50",
                   fontsize=10)
    cost.legend(fontsize=8)
    memory.plot(x, [p["peak_memory_mib"] for p in points], color="black")
    goal_line(memory, goals.MEMORY_AT_200_MIB, "goal at 200 slices: at most 2 GiB")
    memory.set(xlabel="slices inserted", ylabel="peak memory of the process (MiB)", ylim=(0, None))
    save(figure, "slices")


def vertices(points):
    figure, axes = plt.subplots(figsize=(6, 4))
    stage_lines(axes, points)
    axes.set(xscale="log", yscale="log", xlabel="contour vertices of 20 slices", ylabel="time for all slices (ms)")
    axes.legend(fontsize=8, ncols=2)
    save(figure, "vertices")


def depth(points):
    figure, axes = plt.subplots(figsize=(6, 4))
    stage_lines(axes, points)
    first = points[0]
    axes.plot([p["x"] for p in points], [first["total_ms"] * 4 ** (p["x"] - first["x"]) for p in points], ":",
              color="black", linewidth=1, label="4 times a level")
    axes.set(yscale="log", xticks=[p["x"] for p in points], xlabel="depth (finest cells a side: 2^depth)",
             ylabel="time for 20 slices (ms)")
    axes.legend(fontsize=8, ncols=2)
    save(figure, "depth")


def labels(apart, touching):
    figure, axes = plt.subplots(figsize=(6, 4))
    for points, name, colour in ((touching, "touching", "#d62728"), (apart, "apart", "#1f77b4")):
        x = [p["x"] for p in points]
        axes.plot(x, [p["total_ms"] for p in points], "o-", color=colour, linewidth=2,
                  label=f"32 balls {name}: 32 labels take {goals.labels_ratio(points):.2f} times as long as 2")
    two = next(p["total_ms"] for p in touching if p["x"] == 2)
    goal_line(axes, goals.LABELS_RATIO * two, "goal for touching: at most twice the time of 2 labels")
    axes.set_xscale("log", base=2)
    axes.set(xlabel="labels (the same contours)", ylabel="time for 20 slices (ms)",
             ylim=(0, 1.5 * goals.LABELS_RATIO * two), xticks=[p["x"] for p in apart])
    axes.set_xticklabels([f"{p['x']:.0f}" for p in apart])
    axes.legend(fontsize=8, loc="upper left")
    save(figure, "labels")


def threads(points):
    figure, axes = plt.subplots(figsize=(6, 4))
    names = ["total"] + [stage for stage, _ in STAGES]
    for i, point in enumerate(points):
        at = [k + (i - (len(points) - 1) / 2) * 0.38 for k in range(len(names))]
        times = [point[f"{name}_ms"] for name in names]
        bars = axes.bar(at, times, 0.36, color=["#1f77b4", "#ff7f0e"][i], label=f"{point['x']:.0f} thread{'s' if i else ''}")
        gain = [points[0][f"{name}_ms"] / time for name, time in zip(names, times)]
        axes.bar_label(bars, [f"{g:.2f}×" for g in gain] if i else [""] * len(gain), fontsize=8)
    axes.set(xticks=range(len(names)), ylabel="time for 20 slices, depth 9 (ms)")
    axes.set_xticklabels(names)
    axes.grid(axis="x", visible=False)
    axes.legend(fontsize=8)
    save(figure, "threads")


def write_page(result):
    before, rest = PAGE.read_text().split(BEGIN)
    after = rest.split(END)[1]
    PAGE.write_text(f"{before}{BEGIN}```\n{table.text(result)}\n```\n{END}{after}")


def write(result):
    curves = {name: goals.curve(result["records"], name)
              for name in ("slices", "vertices", "depth", "labels apart", "labels touching", "threads")}
    slices(curves["slices"])
    vertices(curves["vertices"])
    depth(curves["depth"])
    labels(curves["labels apart"], curves["labels touching"])
    threads(curves["threads"])
    write_page(result)
