"""Makes the pictures of docs/accuracy.md.

Usage: pictures.py DIRECTORY, where `meniscus ablate … --out` has left these two:

    meniscus ablate refraction/planar refraction/combined refraction/bounded \\
        --scene pool --set water.rms_slope=0.1 --truth displaced --rounds 1 --out DIRECTORY/pool
    meniscus ablate refraction/planar refraction/combined refraction/bounded steps/residual \\
        --scene underwater --set water.rms_slope=0.1 --truth displaced --rounds 1 --out DIRECTORY/underwater

and steps/residual of the pool as well. Needs numpy and Pillow. Crops are enlarged, in this order:
planar, combined, bounded, truth.
"""

import json
import sys
from pathlib import Path

import numpy as np
from PIL import Image

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))
from recompute import Camera, Water, position_errors  # noqa: E402

COLUMNS = ["refraction-planar", "refraction-combined", "refraction-bounded", "truth"]
# Left, top; each is 112 by 84 pixels.
CROPS = {
    "screen-edge": ("pool", 0, 276),
    "waterline": ("pool", 396, 96),
    "object-edges": ("pool", 236, 150),
    "snells-window": ("underwater", 300, 40),
}
SIZE, ZOOM, GAP = (112, 84), 2, 4
PICTURES = Path(__file__).parent.parent / "examples" / "pictures"


def crops(folder):
    for name, (scene, left, top) in CROPS.items():
        width = len(COLUMNS) * (SIZE[0] * ZOOM + GAP) - GAP
        strip = Image.new("RGB", (width, SIZE[1] * ZOOM), "white")
        for i, column in enumerate(COLUMNS):
            picture = Image.open(folder / scene / f"{column}.png").convert("RGB")
            crop = picture.crop((left, top, left + SIZE[0], top + SIZE[1]))
            crop = crop.resize((SIZE[0] * ZOOM, SIZE[1] * ZOOM), Image.NEAREST)
            strip.paste(crop, (i * (SIZE[0] * ZOOM + GAP), 0))
        strip = strip.quantize(128, dither=Image.Dither.NONE)
        strip.save(PICTURES / f"{name}.png", optimize=True)


def linear(srgb):
    srgb = srgb / 255.0
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def residuals(folder):
    """Residuals and errors in pixels, and whether another object is shown, of the water's pixels."""
    grey = np.asarray(Image.open(folder / "steps-residual.png").convert("RGB"))[..., 0]
    residual = 2.0 ** (40.0 * (linear(grey) - 0.5))
    scene = json.loads((folder / "scene.json").read_text(encoding="utf-8"))
    camera, water = Camera(scene["camera"]), Water(scene["water"], displaced=True)
    shown, truth = (np.load(folder / f"{name}.npy").reshape(-1, 4) for name in ("steps-residual.shown", "truth"))
    wet, total = (np.load(folder / f"{name}.npy").ravel() for name in ("water", "total"))
    error, wrong = position_errors(shown.astype(float), truth, total, camera, water)
    return residual.ravel()[wet], error[wet], wrong[wet]


BINS = [0, 2.0**-8, 2.0**-6, 2.0**-4, 0.125, 0.25, 0.5, 1, 2, 8, 1e3, 1e9]


def table(folder):
    residual, error, wrong = residuals(folder)
    print("| residual, px | share of the water | median error, px | 99 % | beyond ½ px | wrong object |")
    print("|---|---|---|---|---|---|")
    for low, high in zip(BINS, BINS[1:]):
        inside = (residual >= low) & (residual < high)
        if not inside.any():
            continue
        e, w = error[inside], wrong[inside]
        end = "∞" if high >= 1e9 else f"{high:.3g}"
        print(
            f"| {low:.2g} – {end} | {inside.mean():.3%} | {np.median(e):.2g} "
            f"| {np.quantile(e, 0.99):.2g} | {(e > 0.5).mean():.3%} | {w.mean():.3%} |"
        )


def plot(folder):
    """Residual against error, both logarithmic: a count a cell, darker for more."""
    residual, error, _ = residuals(folder)
    edges = np.linspace(-12, 12, 97)
    x = np.clip(np.log2(np.maximum(residual, 1e-9)), -11.99, 11.99)
    y = np.clip(np.log2(np.maximum(error, 1e-9)), -11.99, 11.99)
    counts, _, _ = np.histogram2d(y, x, bins=(edges, edges))
    grey = 255 * (1 - np.log1p(counts[::-1]) / np.log1p(counts.max()))
    picture = np.repeat(grey.astype(np.uint8)[..., None], 3, axis=2)
    for value in (0.25, 0.5):
        at = int((np.log2(value) + 12) * 4)
        if value == 0.25:
            picture[:, at] = np.minimum(picture[:, at], [255, 90, 60])
        else:
            picture[96 - at] = np.minimum(picture[96 - at], [60, 120, 255])
    picture = Image.fromarray(picture).resize((384, 384), Image.NEAREST)
    picture.quantize(64).save(PICTURES / "residual-error.png", optimize=True)


def main():
    folder = Path(sys.argv[1])
    crops(folder)
    plot(folder / "pool")
    table(folder / "pool")


main()
