"""Prints Markdown tables: of a sweep over scenes and slopes, or of one ablation's rows.

Usage: accuracy.py RESULTS.json
"""

import json
import sys


def cell(row):
    """Within half a pixel / wrong object / traced; unlisted beyond half a pixel: all in per cent."""
    error = row["error"]
    text = f"{100 * error['within_half_px']:.2f} / {100 * error['wrong_object']:.3f}"
    lists = row.get("lists", {}).get("rays_traced")
    if lists is None:
        return text + f" / mean {error['position_px']['mean']:.4f} px"
    return text + f" / {100 * lists['listed']:.1f} ({100 * lists['unlisted_beyond_half_px']:.3f})"


def rows_table(rows):
    """Mean error, shares in per cent, and frame times relative to the baseline."""
    print("| pipeline | mean px | ≤ ½ px, % | wrong, % | traced, % | RMSE | time |")
    print("|---|---|---|---|---|---|---|")
    for row in rows:
        error, lists = row["error"], row.get("lists", {}).get("rays_traced")
        traced = f"{100 * lists['listed']:.1f}" if lists else "–"
        time = f"{row['relative']['median']:.2f}" if "relative" in row else "–"
        print(
            f"| {row['pipeline']} | {error['position_px']['mean']:.4f} | {100 * error['within_half_px']:.2f} "
            f"| {100 * error['wrong_object']:.3f} | {traced} | {error['rmse']:.4f} | {time} |"
        )


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        results = json.load(file)
    if "rows" in results:
        rows_table(results["rows"])
        return
    points = results["points"]
    rows, slopes = {}, []
    for point in points:
        swept = dict(point["sweep"]["swept"])
        slope = swept["water.rms_slope"]
        if slope not in slopes:
            slopes.append(slope)
        for row in point["rows"]:
            name = f"{swept['scene']}, {row['pipeline'].split('/')[-1]}"
            rows.setdefault(name, {})[slope] = cell(row)
    print("| scene | " + " | ".join(f"slope {slope}" for slope in slopes) + " |")
    print("|---" * (len(slopes) + 1) + "|")
    for name, cells in rows.items():
        print(f"| {name} | " + " | ".join(cells[slope] for slope in slopes) + " |")


main()
