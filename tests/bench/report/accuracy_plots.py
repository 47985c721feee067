"""Draws error over noise and over planes out of bench_accuracy's records into docs/bench."""
import accuracy
import plots

plt = plots.plt
COLOURS = {"step": "#7f7f7f", "smooth": "#1f77b4"}


def means(records, key, **wanted):
    """(values, means of 1 - IoU in %) for each field."""
    values = sorted(accuracy.values_of(records, key, **wanted))
    pairs = [accuracy.by_field(records, **{key: value}, **wanted) for value in values]
    return {field: (values, [100 * (1 - sum(pair[i]["iou"] for pair in p) / len(p)) for p in pairs])
            for i, field in enumerate(accuracy.FIELDS)}


def curves(axes, records, key, name, marker, **wanted):
    if not accuracy.values_of(records, key, **wanted):
        return
    for field, (x, y) in means(records, key, **wanted).items():
        axes.plot(x, y, marker, color=COLOURS[field], markersize=5, label=f"{name}, {field}")


def finish(figure, axes, name, label):
    axes.set(xlabel=label, ylabel="1 - IoU (%)", ylim=(0, None))
    axes.legend(fontsize=8)
    plots.save(figure, name)


def write(records):
    figure, axes = plt.subplots(figsize=(6, 4))
    curves(axes, records, "noise_percent", "recorded stacks", "o-", group="recorded")
    curves(axes, records, "noise_percent", "meshes, 20 planes", "s--", group="meshes", count=20)
    finish(figure, axes, "accuracy_noise", "noise of contour points (% of the diagonal)")
    figure, axes = plt.subplots(figsize=(6, 4))
    curves(axes, records, "count", "bodies", "o-", group="bodies", planes="random")
    curves(axes, records, "count", "camel", "s--", group="meshes", set="camel", noise_percent=0)
    curves(axes, records, "count", "femur", "^:", group="meshes", set="femur", noise_percent=0)
    axes.set(xscale="log", xticks=[10, 20, 40])
    axes.set_xticklabels(["10", "20", "40"])
    axes.minorticks_off()
    finish(figure, axes, "accuracy_planes", "planes in free directions")
