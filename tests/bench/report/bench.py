"""Runs the benchmarks, prints one table of them and writes everything to build/release/bench.json."""
import argparse
import json
import os
import pathlib
import subprocess
import sys
import time

import accuracy
import methods
import table

BUILD = pathlib.Path("build/release")
SETS = pathlib.Path("../shared/data/csl")
DEPTH = 8
ALSO_FINER = "Vetebrae"


def run(program, *arguments):
    """The figures that a program prints: one object a line. Its words pass on to the terminal."""
    path = BUILD / "bin" / program
    output = subprocess.run([path, *map(str, arguments)], stdout=subprocess.PIPE, check=True, text=True).stdout
    return [json.loads(line) for line in output.splitlines()]


def busy_share():
    """Of the processors' time, what others took in one second before the first figure."""
    def times():
        return [int(word) for word in open("/proc/stat").readline().split()[1:8]]

    before = times()
    time.sleep(1)
    spent = [after - earlier for earlier, after in zip(before, times())]
    return 1 - (spent[3] + spent[4]) / sum(spent)  # idle and waiting for disks


def machine():
    lines = [line.split(":", 1) for line in open("/proc/cpuinfo") if ":" in line]
    facts = {name.strip(): value.strip() for name, value in lines}
    flags = facts.get("flags", "").split()
    vectors = "AVX-512" if "avx512f" in flags else "AVX2" if "avx2" in flags else "no AVX2"
    return {"cpu": facts.get("model name", "unknown"), "cores": os.cpu_count(), "vectors": vectors,
            "busy_share": busy_share()}


def measure_sets():
    if not SETS.is_dir():
        print(f"SKIP: {SETS} is absent", file=sys.stderr)
        return []
    records = []
    for path in sorted(SETS.glob("*.csl"), key=lambda p: p.stem.lower()):
        for depth in (DEPTH, DEPTH + 1) if path.stem == ALSO_FINER else (DEPTH,):
            records += run("bench_set", path, depth) + run("bench_quality", path, depth)
        if (BUILD / "bin/bench_delaunay").exists():
            records += run("bench_delaunay", path, DEPTH)
    return records


def measure_unknown():
    """What was not measured: masked sets completed in both ways, and a long sweep of a sector."""
    paths = [SETS / f"{name}.csl" for name in ("Heart-25-even-better", "Vetebrae", "eight_20", "Horsers")]
    masked = run("bench_unknown", "--published", 6, 1, *paths) if SETS.is_dir() else []
    return masked + run("bench_sweep", "passes", 1000) + run("bench_sweep", "still", 300)


def compare_methods(renew_page):
    records = methods.measure(run, SETS)
    (BUILD / "bench-methods.json").write_text(json.dumps({"machine": machine(), "records": records}, indent=1))
    words = f"{table.machine_text(machine())}\n\n{methods.text(records)}"
    print(words)
    if renew_page:
        methods.write_page(words)


def measure_accuracy(renew_page):
    records = run("bench_accuracy", accuracy.DEPTH)
    (BUILD / "bench-accuracy.json").write_text(json.dumps({"machine": machine(), "records": records}, indent=1))
    print(accuracy.text(records))
    if renew_page:
        import accuracy_plots  # here, because a plain run needs no matplotlib

        accuracy.write_page(records)
        accuracy_plots.write(records)


def main():
    parser = argparse.ArgumentParser(prog="run bench", description=__doc__)
    parser.add_argument("part", nargs="?", choices=["methods", "accuracy"],
                        help="only the methods of docs/methods.md, only the accuracy of docs/accuracy.md")
    parser.add_argument("--plots", action="store_true", help="also draw the plots of docs/bench and renew its table; "
                        "of methods and accuracy: renew their own pages")
    options = parser.parse_args()
    if options.part == "methods":
        return compare_methods(options.plots)
    if options.part == "accuracy":
        return measure_accuracy(options.plots)
    start = time.monotonic()
    result = {"machine": machine(), "records": run("bench_wire") + run("bench_field") + run("bench_mesh") +
              run("bench_background") + measure_sets() + measure_unknown()}
    for curve in ("slices", "stack", "vertices", "depth", "labels", "threads"):
        result["records"] += run("bench_scaling", curve)
    result["seconds"] = time.monotonic() - start
    (BUILD / "bench.json").write_text(json.dumps(result, indent=1))
    print(table.text(result))
    if options.plots:
        import plots  # here, because a plain run needs no matplotlib

        plots.write(result)


main()
