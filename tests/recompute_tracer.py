"""Rays through air and water to triangles, many at once, in float64.

Written from the equations and not from the Rust tracer: another test of triangles, another march over
the waves, another solution of the crossing. What agrees is then unlikely to be wrong in both.
"""

from dataclasses import dataclass

import numpy as np

# A ray meets the water at most this often; after that it passes through unhindered.
MAX_EVENTS = 4
LEAF = 16
# Rays that are handled together in a leaf; bounds the memory.
BATCH = 1 << 15


def dot(a, b):
    """Row by row."""
    return np.einsum("ij,ij->i", a, b)


def refract(incident, normal, ratio):
    """Snell's law for unit vectors; `normal` against `incident`, `ratio` = n₁ / n₂.

    Returns the directions, reflected ones where the reflection is total, and where it is."""
    cosine = -dot(incident, normal)
    square = 1.0 - ratio**2 * (1.0 - cosine**2)
    total = square <= 0.0
    along = (ratio * cosine - np.sqrt(np.maximum(square, 0.0)))[:, None]
    through = np.asarray(ratio)[:, None] * incident + along * normal
    back = incident + 2.0 * cosine[:, None] * normal
    out = np.where(total[:, None], back, through)
    return out / np.linalg.norm(out, axis=1, keepdims=True), total


def crossing(above, below, distance, near_index, far_index):
    """How far along a plane light from a point `above` crosses it on its way to points `below`,
    `distance` away along the plane. Bisects the difference of the two sides of Snell's law."""
    low, high = np.zeros_like(distance), np.array(distance)
    for _ in range(64):
        x = 0.5 * (low + high)
        rest = distance - x
        far = near_index * x / np.hypot(above, x) > far_index * rest / np.hypot(below, rest)
        high = np.where(far, x, high)
        low = np.where(far, low, x)
    return 0.5 * (low + high)


class Triangles:
    """Triangles in a tree of boxes, which all rays walk together."""

    def __init__(self, corners, objects):
        edges = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=1)
        normals = np.cross(edges[:, 0], edges[:, 1])
        length = np.linalg.norm(normals, axis=1)
        # A triangle without area is seen by nobody.
        solid = length > 0
        corners, edges = corners[solid], edges[solid]
        normals = normals[solid] / length[solid, None]
        self.object = np.asarray(objects)[solid]
        # Carries a triangle to (0, 0, 0), (1, 0, 0), (0, 1, 0): Woop 2004, "unit triangle".
        frames = np.stack([edges[:, 0], edges[:, 1], normals], axis=2)
        self.carry = np.linalg.inv(frames) if len(frames) else frames
        self.shift = -np.einsum("tij,tj->ti", self.carry, corners[:, 0])
        self.nodes = []
        if len(corners):
            size = np.abs(corners).max()
            low, high = corners.min(axis=1) - 1e-12 * size, corners.max(axis=1) + 1e-12 * size
            self._split(np.arange(len(corners)), low, high)

    def _split(self, indices, low, high):
        place = len(self.nodes)
        bounds = (low[indices].min(axis=0), high[indices].max(axis=0))
        self.nodes.append(None)
        if len(indices) <= LEAF:
            self.nodes[place] = (bounds, None, indices)
            return place
        centres = low[indices] + high[indices]
        axis = np.argmax(np.ptp(centres, axis=0))
        order = indices[np.argsort(centres[:, axis], kind="stable")]
        half = len(order) // 2
        children = (self._split(order[:half], low, high), self._split(order[half:], low, high))
        self.nodes[place] = (bounds, children, None)
        return place

    def nearest(self, origins, directions, near):
        """Distance along each ray to the first triangle at or beyond `near`, inf where there is
        none, and that triangle's object, −1 where there is none."""
        best = np.full(len(directions), np.inf)
        found = np.full(len(directions), -1)
        away = np.where(np.abs(directions) < 1e-300, 1e-300, directions)
        inverse = 1.0 / away
        stack = [(0, np.arange(len(directions)))] if self.nodes else []
        while stack:
            node, rays = stack.pop()
            (low, high), children, indices = self.nodes[node]
            a = (low - origins[rays]) * inverse[rays]
            b = (high - origins[rays]) * inverse[rays]
            enter = np.minimum(a, b).max(axis=1)
            leave = np.maximum(a, b).min(axis=1)
            rays = rays[(enter <= leave) & (leave >= near[rays]) & (enter <= best[rays])]
            if not len(rays):
                continue
            if children is not None:
                stack += [(child, rays) for child in children]
                continue
            for start in range(0, len(rays), BATCH):
                some = rays[start : start + BATCH]
                t = self._meet(indices, origins[some], directions[some], near[some])
                closest = t.argmin(axis=1)
                t = t[np.arange(len(some)), closest]
                closer = t < best[some]
                best[some[closer]] = t[closer]
                found[some[closer]] = indices[closest[closer]]
        objects = np.where(found < 0, -1, self.object[found] if len(self.object) else -1)
        return best, objects

    def _meet(self, indices, origins, directions, near):
        """Distances of rays (rows) to triangles (columns), inf where they miss."""
        carry = self.carry[indices].reshape(-1, 3).T
        shape = (len(origins), len(indices), 3)
        o = (origins @ carry).reshape(shape) + self.shift[indices]
        d = (directions @ carry).reshape(shape)
        with np.errstate(divide="ignore", invalid="ignore"):
            t = -o[..., 2] / d[..., 2]
            u = o[..., 0] + t * d[..., 0]
            v = o[..., 1] + t * d[..., 1]
            # Neighbours overlap by a trifle, so that no ray slips through an edge.
            inside = (u >= -1e-10) & (v >= -1e-10) & (u + v <= 1.0 + 1e-10)
            return np.where(inside & (t >= near[:, None]), t, np.inf)


class Water:
    """The surface: a plane with the waves' normals, or the waves themselves."""

    def __init__(self, export, displaced):
        self.level, self.index = export["level"], export["refractive_index"]
        waves = [wave for wave in export["waves"] if wave["amplitude"] != 0]
        self.amplitude = np.array([wave["amplitude"] for wave in waves], dtype=float)
        self.vector = np.array([wave["wave_vector"] for wave in waves], dtype=float).reshape(-1, 2)
        frequency = np.array([wave["angular_frequency"] for wave in waves], dtype=float)
        phase = np.array([wave["phase"] for wave in waves], dtype=float)
        self.phase = phase - frequency * export["time"]
        self.displaced = displaced and len(waves) > 0
        self.reach = np.abs(self.amplitude).sum()

    def height(self, xy):
        """Of the waves over the rest plane."""
        return np.sin(xy @ self.vector.T + self.phase) @ self.amplitude

    def normal(self, xy):
        """Unit, upwards."""
        gradient = (np.cos(xy @ self.vector.T + self.phase) * self.amplitude) @ self.vector
        normal = np.hstack([-gradient, np.ones((len(xy), 1))])
        return normal / np.linalg.norm(normal, axis=1, keepdims=True)

    def side(self, points):
        """+1 in air, −1 in water."""
        surface = self.level + (self.height(points[:, :2]) if self.displaced else 0.0)
        return np.where(points[:, 2] >= surface, 1.0, -1.0)

    def meet(self, origins, directions, side, limit):
        """Distance to where rays leave their side, inf where not before `limit`."""
        height = side * (origins[:, 2] - self.level)
        climb = side * directions[:, 2]
        if self.displaced:
            return self._march(origins, directions, side, limit, height, climb)
        falling = climb < 0
        t = np.maximum(height, 0.0) / -np.where(falling, climb, -1.0)
        return np.where(falling & (t < limit), t, np.inf)

    def _march(self, origins, directions, side, limit, height, climb):
        """Small steps through the band that holds the waves until the side changes, then halves."""
        safe = np.where(np.abs(climb) < 1e-300, 1e-300, climb)
        start = np.where(height > self.reach, (self.reach - height) / safe, 0.0)
        start[(height > self.reach) & (climb >= 0)] = np.inf
        bound = np.where(climb > 0, self.reach - height, -self.reach - height)
        end = np.minimum(bound / safe + 1e-9, limit)
        shortest = 2 * np.pi / np.linalg.norm(self.vector, axis=1).max()
        pace = np.hypot(directions[:, 0], directions[:, 1]) * 40 / shortest
        step = 1.0 / (pace + np.abs(climb) * 4 / self.reach)
        found = np.full(len(origins), np.inf)

        def outside(rays, t):
            points = origins[rays] + t[:, None] * directions[rays]
            return side[rays] * (points[:, 2] - self.level - self.height(points[:, :2])) > 0

        rays = np.flatnonzero(start < end)
        t = start[rays]
        for _ in range(100_000):
            if not len(rays):
                break
            next_t = np.minimum(t + step[rays], end[rays])
            out = outside(rays, next_t)
            crossed, low, high = rays[~out], t[~out], next_t[~out]
            for _ in range(60):
                middle = 0.5 * (low + high)
                out_there = outside(crossed, middle)
                low, high = np.where(out_there, middle, low), np.where(out_there, high, middle)
            found[crossed] = np.where(high < limit[crossed], high, np.inf)
            on = out & (next_t < end[rays])
            rays, t = rays[on], next_t[on]
        return found


@dataclass
class Path:
    """What became of each ray."""

    water_first: np.ndarray
    undefined: np.ndarray
    total: np.ndarray
    object: np.ndarray
    point: np.ndarray


class Tracer:
    """Triangles and water together."""

    def __init__(self, solids, water):
        self.solids, self.water = solids, water

    def follow(self, eye, directions, near, events=MAX_EVENTS):
        """Follows rays from the eye; solids before `near` are not seen unless through water.

        With fewer `events`, rays end at the last of them, and object and point mean nothing."""
        count, water = len(directions), self.water
        path = Path(*(np.zeros(count, dtype=bool) for _ in range(3)), np.full(count, -1), np.zeros((count, 3)))
        rays = np.arange(count)
        origin, direction = np.tile(eye, (count, 1)).astype(float), directions
        side = water.side(origin)
        for event in range(MAX_EVENTS + 1):
            if event > 0 and event == events < MAX_EVENTS:
                break
            solid, objects = self.solids.nearest(origin, direction, near)
            t = np.full(len(rays), np.inf)
            if event < MAX_EVENTS:
                t = water.meet(origin, direction, side, solid)
            dry = np.isinf(t)
            ended = dry & np.isfinite(solid)
            path.object[rays[ended]] = objects[ended]
            path.point[rays[ended]] = origin[ended] + solid[ended, None] * direction[ended]
            wet = ~dry
            rays, origin, direction, side = rays[wet], origin[wet], direction[wet], side[wet]
            origin = origin + t[wet, None] * direction
            if not water.displaced:
                origin[:, 2] = water.level
            normal = side[:, None] * water.normal(origin[:, :2])
            facing = dot(direction, normal) < 0
            ratio = np.where(side > 0, 1.0 / water.index, water.index)
            deflected, total = refract(direction, normal, ratio)
            ahead = np.where(total, side, -side)
            valid = facing & (water.displaced | (ahead * deflected[:, 2] > 0))
            path.undefined[rays[~valid]] = True
            if event == 0:
                path.water_first[rays] = True
                path.total[rays[valid & total]] = True
            rays, origin, direction = rays[valid], origin[valid], deflected[valid]
            side, near = ahead[valid], np.zeros(valid.sum())
        return path
