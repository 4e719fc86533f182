#!/usr/bin/env python3
"""Recomputes the position errors of an ablation with a tracer of its own. Needs numpy alone.

    meniscus ablate … --out DIR         writes the pictures, and the numbers behind them
    python3 tests/recompute.py DIR      checks the numbers; exit 0: they agree, 1: they do not,
                                        2: DIR is not what an ablation leaves behind
    python3 tests/recompute.py --laws   checks this script by the laws of optics

Read from DIR, arrays having a row of the picture first, its columns next:

    scene.json       camera, water terms, triangles with object ids
    truth.npy        (H, W, 4) true world point, metres, and object id, −1 where nothing is seen
    water.npy        (H, W) whether the true ray meets water first
    undefined.npy    (H, W) whether it has no physical answer there
    total.npy        (H, W) whether it is totally reflected there
    NAME.shown.npy   (H, W, 4) as truth.npy, for the colour that a pipeline shows; NAME is the
                     pipeline's name, characters other than letters, digits and -_.=, being -
    results.json     the figures to check

Checked are: on every pixel, what the ray from the eye meets first (the masks); on every STEPth row
and column, the true point and object; per pipeline, over all water pixels, the figures made of
position errors. World space is right-handed, z up, metres; pixel centres stand at half integers.
"""

import argparse
import json
import re
import sys
import time
from pathlib import Path

try:
    import numpy as np
except ImportError:
    sys.exit("recompute.py needs numpy: python3 -m pip install numpy")

sys.dont_write_bytecode = True

from recompute_tracer import Tracer, Triangles, Water, crossing

# What two tracers in f64 may differ by. Shares are of pixels.
POINT_M = 1e-4
FIGURE_PX = 1e-3
SHARE = 1e-4
TRACED_SHARE = 1e-3
SUMMARY = {"median": 0.5, "p95": 0.95, "p99": 0.99}


class Camera:
    """A pinhole camera."""

    def __init__(self, export):
        for name in ("eye", "right", "up", "forward"):
            setattr(self, name, np.array(export[name]))
        self.focal, self.near = export["focal"], export["near"]
        self.width, self.height = export["size"]
        self.matrix = np.array(export["world_to_pixel"])

    def directions(self):
        """Unit directions through the centres of all pixels, row by row."""
        x, y = np.meshgrid(np.arange(self.width) + 0.5, np.arange(self.height) + 0.5)
        x, y = x.ravel()[:, None] - self.width / 2, y.ravel()[:, None] - self.height / 2
        rays = self.focal * self.forward + x * self.right - y * self.up
        return rays / np.linalg.norm(rays, axis=1, keepdims=True)

    def project(self, points):
        """Places in the picture, pixels; NaN behind the eye."""
        offsets = points - self.eye
        depth = offsets @ self.forward
        scale = self.focal / np.where(depth > 0, depth, np.nan)
        x = self.width / 2 + scale * (offsets @ self.right)
        y = self.height / 2 - scale * (offsets @ self.up)
        return np.stack([x, y], axis=1)

    def matrix_error(self):
        """By how many pixels the exported matrix and the rays contradict each other."""
        pixels = self.project(self.eye + 3.0 * self.directions())
        points = self.eye + 3.0 * self.directions()
        carried = points @ self.matrix[:, :3].T + self.matrix[:, 3]
        return np.abs(carried[:, :2] / carried[:, 2:] - pixels).max()


def apparent(points, total, camera, water):
    """Where points appear through flat water, or, where `total`, in the mirror of its plane."""
    side = 1.0 if camera.eye[2] >= water.level else -1.0
    above = max(abs(camera.eye[2] - water.level), 1e-30)
    below = side * (water.level - points[:, 2])
    across = points[:, :2] - camera.eye[:2]
    distance = np.hypot(across[:, 0], across[:, 1])
    seen = points.copy()
    mirrored = total
    seen[mirrored, 2] = 2.0 * water.level - seen[mirrored, 2]
    refracted = ~total & (below > 0) & (distance > 0)
    near, far = (1.0, water.index) if side > 0 else (water.index, 1.0)
    x = crossing(above, below[refracted], distance[refracted], near, far)
    towards = across[refracted] / distance[refracted, None] * x[:, None]
    down = np.full((len(x), 1), -side * above)
    seen[refracted] = camera.eye + np.hstack([towards, down])
    return camera.project(seen)


def position_errors(shown, truth, total, camera, water):
    """Errors in pixels, and whether another object is shown than the true one."""
    readable = np.isfinite(shown[:, 3])
    ids = np.where(readable, np.floor(np.nan_to_num(shown[:, 3]) + 0.5), np.nan)
    ids[shown[:, 3] < 0] = -1
    true_ids = truth[:, 3]
    missed, true_missed = ids < 0, true_ids < 0
    broken = ~np.isfinite(shown).all(axis=1)
    points = np.where(np.isfinite(shown[:, :3]), shown[:, :3], 0.0).astype(float)
    ours = apparent(points, total, camera, water)
    theirs = apparent(truth[:, :3], total, camera, water)
    error = np.hypot(*(ours - theirs).T)
    error[(points == truth[:, :3]).all(axis=1)] = 0.0
    diagonal = np.hypot(camera.width, camera.height)
    error[missed & true_missed] = 0.0
    error[(missed != true_missed) | broken | np.isnan(error)] = diagonal
    # A NaN id equals none.
    return np.minimum(error, diagonal), ~(missed & true_missed) & (ids != true_ids)


class Check:
    """Gathers what agrees and what does not, and prints it."""

    def __init__(self):
        self.agrees = True

    def say(self, what, agrees, figures):
        self.agrees &= bool(agrees)
        print(f"{'ok ' if agrees else 'OFF'} {what}: {figures}")

    def row(self, name, agrees, ours, theirs):
        """A row of what was recomputed, over one of what it should be."""
        self.agrees &= bool(agrees)
        for start, figures in ((f"{'ok ' if agrees else 'OFF'} {name}", ours), ("", theirs)):
            print(f"{start:40}" + "".join(f"{figure:>11}" for figure in figures))


def check_truth(check, folder, camera, water, tracer, step):
    """Compares masks and true points; returns (truth, judged pixels, total), pixels in one row."""
    truth = load(folder / "truth.npy", camera, 4).reshape(-1, 4)
    masks = {}
    for name in ("water", "undefined", "total"):
        masks[name] = load(folder / f"{name}.npy", camera, None).ravel().astype(bool)
    directions = camera.directions()
    near = camera.near / np.maximum(directions @ camera.forward, 1e-300)
    first = tracer.follow(camera.eye, directions, near, events=1)
    for name, ours in (
        ("water", first.water_first),
        ("undefined", first.undefined),
        ("total", first.total),
    ):
        differ = np.mean(ours != masks[name])
        check.say(f"{name}.npy", differ <= SHARE, f"{ours.sum()} pixels, {differ:.4%} differ")

    y, x = np.mgrid[step // 2 : camera.height : step, step // 2 : camera.width : step]
    some = (y * camera.width + x).ravel()
    path = tracer.follow(camera.eye, directions[some], near[some])
    defined = ~path.undefined & ~masks["undefined"][some]
    # What a path without an answer would see means nothing.
    some = some[defined]
    ids, points = path.object[defined], path.point[defined]
    same = ids == truth[some, 3]
    away = np.linalg.norm(points - truth[some, :3], axis=1)[same & (ids >= 0)]
    check.say(
        "objects in truth.npy",
        np.mean(~same) <= TRACED_SHARE,
        f"{len(some)} pixels traced, {np.mean(~same):.4%} differ",
    )
    far = np.mean(away > POINT_M) if len(away) else 0.0
    largest = away.max() if len(away) else 0.0
    check.say(
        "points in truth.npy",
        far <= TRACED_SHARE,
        f"{far:.4%} farther than {POINT_M} m, largest {largest:.2g} m",
    )
    return truth, masks["water"] & ~masks["undefined"], masks


def check_rows(check, folder, camera, water, results, truth, judged, total):
    """Compares each pipeline's figures of position errors."""
    truth, total = truth[judged], total[judged]
    for row in results["rows"]:
        name = re.sub(r"[^A-Za-z0-9\-_.=,]", "-", row["pipeline"])
        shown = load(folder / f"{name}.shown.npy", camera, 4).reshape(-1, 4)[judged]
        if row["error"] is None or not len(shown):
            check.say(row["pipeline"], row["error"] is None and not len(shown), "no water seen")
            continue
        error, wrong = position_errors(shown, truth, total, camera, water)
        ours = {"mean": error.mean()}
        ours.update({key: np.quantile(error, q) for key, q in SUMMARY.items()})
        theirs = dict(row["error"]["position_px"])
        shares = {"within_half_px": np.mean(error <= 0.5), "wrong_object": np.mean(wrong)}
        agrees = all(abs(ours[k] - theirs[k]) <= FIGURE_PX for k in ours) and all(
            abs(shares[k] - row["error"][k]) <= SHARE for k in shares
        )
        check.row(
            row["pipeline"],
            agrees,
            [f"{ours[k]:.4f}" for k in ours] + [f"{shares[k]:.3%}" for k in shares],
            [f"{theirs[k]:.4f}" for k in ours] + [f"{row['error'][k]:.3%}" for k in shares],
        )


def load(path, camera, channels):
    """An array of the size of the picture."""
    array = np.load(path, allow_pickle=False)
    shape = (camera.height, camera.width) + ((channels,) if channels else ())
    if array.shape != shape:
        raise ValueError(f"{path}: of shape {array.shape}, where {shape} is needed")
    return array


def read_scene(folder, results):
    """The camera, the water with the truth's geometry, and the tracer."""
    scene = json.loads((folder / "scene.json").read_text(encoding="utf-8"))
    camera = Camera(scene["camera"])
    water = Water(scene["water"], displaced=results["truth"] == "displaced")
    # The exported decimals are the shortest that give the f32 back.
    positions = np.array(scene["positions"], dtype=np.float32).astype(float)
    triangles = np.array(scene["triangles"], dtype=np.int64).reshape(-1, 4)
    return camera, water, Tracer(Triangles(positions[triangles[:, :3]], triangles[:, 3]), water)


def recompute(folder, step):
    """Checks a directory; whether all agrees."""
    start = time.monotonic()
    results = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    camera, water, tracer = read_scene(folder, results)
    if list(results["size"]) != [camera.width, camera.height]:
        raise ValueError("results.json and scene.json are of different sizes")
    check = Check()
    error = camera.matrix_error()
    check.say("world_to_pixel", error <= 1e-6, f"within {error:.1g} px of the rays")
    truth, judged, masks = check_truth(check, folder, camera, water, tracer, step)
    for key, mask in (
        ("water_pixels", masks["water"]),
        ("undefined_pixels", masks["water"] & masks["undefined"]),
    ):
        check.say(key, mask.sum() == results[key], f"{mask.sum()} ({results[key]})")
    header = ["mean px", *(f"{name} px" for name in SUMMARY), "≤ ½ px", "wrong"]
    print(f"{'recomputed, and below as results.json':40}" + "".join(f"{h:>11}" for h in header))
    check_rows(check, folder, camera, water, results, truth, judged, masks["total"])
    seconds = time.monotonic() - start
    verdict = "All agrees" if check.agrees else "Not all agrees"
    print(f"{verdict} ({len(tracer.solids.object)} triangles, {seconds:.1f} s).")
    return check.agrees


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("directory", nargs="?", type=Path, help="what `ablate --out` wrote")
    parser.add_argument("--step", type=int, default=8, help="rows and columns per traced pixel")
    parser.add_argument("--laws", action="store_true", help="check this script by itself")
    arguments = parser.parse_args()
    if arguments.laws:
        import recompute_laws

        return recompute_laws.main()
    if arguments.directory is None or arguments.step < 1:
        parser.error("a directory is needed, and a step of at least 1")
    try:
        return 0 if recompute(arguments.directory, arguments.step) else 1
    except (OSError, ValueError, KeyError, TypeError, IndexError) as problem:
        kind = type(problem).__name__
        print(f"recompute.py: {arguments.directory}: {kind}: {problem}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(main())
