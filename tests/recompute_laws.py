"""The laws that the tracer of recompute.py has to keep, whatever it is compared with."""

import numpy as np

from recompute_tracer import Tracer, Triangles, Water, crossing, dot, refract


def unit(vectors):
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def facing(rng, count):
    """Unit normals, and unit directions that run against them."""
    normal, incident = unit(rng.normal(size=(count, 3))), unit(rng.normal(size=(count, 3)))
    return normal, np.where((dot(incident, normal) > 0)[:, None], -incident, incident)


def snells_law_holds_and_light_can_go_back(rng):
    normal, incident = facing(rng, 5000)
    for near, far in ((1.0, 1.333), (1.333, 1.0), (1.0, 1.0), (1.0, 2.5)):
        out, total = refract(incident, normal, np.full(5000, near / far))
        sine, out_sine = (np.linalg.norm(np.cross(v, normal), axis=1) for v in (incident, out))
        assert np.allclose(near * sine[~total], far * out_sine[~total], atol=1e-12)
        assert (near * sine[total] >= far * (1 - 1e-12)).all()
        assert total.any() == (near > far)
        assert np.allclose(sine[total], out_sine[total], atol=1e-12)
        assert np.allclose(dot(np.cross(incident, normal), out), 0, atol=1e-12)
        assert ((dot(out, normal) < 0) == ~total).all()
        back, lost = refract(-out[~total], -normal[~total], np.full((~total).sum(), far / near))
        # Near the critical angle half of the digits are lost on the way.
        assert np.allclose(back[~lost], -incident[~total][~lost], atol=1e-6)


def the_crossing_takes_the_least_time(rng):
    below, distance = rng.uniform(0.01, 10, 2000), rng.uniform(0.01, 50, 2000)
    for above, near, far in ((1.7, 1.0, 1.333), (0.3, 1.333, 1.0)):

        def time(x):
            return near * np.hypot(above, x) + far * np.hypot(below, distance - x)

        x = crossing(above, below, distance, near, far)
        for nudge in (-1e-3, 1e-3):
            assert (time(x) <= time(x + nudge * distance)).all()


def triangles_are_hit_where_they_are_aimed_at(rng):
    corners = rng.uniform(-1, 1, (300, 3, 3))
    solids = Triangles(corners, np.arange(300))
    weights = rng.dirichlet((1, 1, 1), 300)
    aims = np.einsum("tc,tcx->tx", weights, corners)
    origins = np.tile([4.0, 5.0, 6.0], (300, 1))
    away = np.linalg.norm(aims - origins, axis=1)
    directions = unit(aims - origins)
    t, objects = solids.nearest(origins, directions, np.zeros(300))
    assert (t <= away + 1e-9).all() and (objects >= 0).all()
    # From just before the aim nothing can be in between.
    t, objects = solids.nearest(origins, directions, away - 1e-7)
    assert np.allclose(t, away, atol=1e-9) and (objects == np.arange(300)).all()
    # All of them together, one by one: the tree leaves none out.
    t, _ = solids.nearest(origins, directions, np.zeros(300))
    alone = [Triangles(c[None], [0]).nearest(origins, directions, np.zeros(300))[0] for c in corners]
    assert np.allclose(t, np.min(alone, axis=0), atol=1e-9)


def box(low, high):
    """Two triangles a side."""
    corners = np.array(np.meshgrid(*zip(low, high), indexing="ij")).reshape(3, 8).T
    sides = ((0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5))
    return np.array([corners[[s[i], s[j], s[k]]] for s in sides for i, j, k in ((0, 1, 2), (0, 2, 3))])


def no_ray_leaves_a_closed_box(rng):
    solids = Triangles(box((-1, -2, -3), (1, 2, 3)), np.zeros(12, dtype=int))
    directions = unit(np.vstack([rng.normal(size=(5000, 3)), np.eye(3), -np.eye(3), [[1, 2, 3]]]))
    t, _ = solids.nearest(np.zeros_like(directions), directions, np.zeros(len(directions)))
    with np.errstate(divide="ignore"):
        wall = np.min(np.array([1, 2, 3]) / np.abs(directions), axis=1)
    assert np.allclose(t, wall, rtol=1e-12)


def waves(displaced, amplitude=0.03):
    terms = (((3.3, 0.7), 0.2, 1.0), ((-1.1, 5.0), 1.9, 0.5), ((7.0, -6.0), 4.0, 0.2))
    listed = [
        {"amplitude": amplitude * a, "wave_vector": k, "angular_frequency": 2.0, "phase": p}
        for k, p, a in terms
    ]
    return Water({"level": 0.4, "refractive_index": 1.333, "time": 0.7, "waves": listed}, displaced)


def rays_stop_at_the_first_wave(rng):
    water = waves(True)
    origins = rng.uniform(-1, 1, (400, 3)) + [0, 0, 1.8]
    directions = unit(np.hstack([rng.normal(size=(400, 2)), rng.uniform(-1, -0.02, (400, 1))]))
    for side, mirror in ((1.0, 1.0), (-1.0, -1.0)):
        # From below, the same rays upside down.
        o, d = origins * [1, 1, mirror] + [0, 0, 0.8 * (mirror < 0)], directions * [1, 1, mirror]
        t = water.meet(o, d, np.full(400, side), np.full(400, np.inf))
        points = o + t[:, None] * d
        assert np.allclose(points[:, 2], 0.4 + water.height(points[:, :2]), atol=1e-9)
        for share in np.linspace(0, 0.9999, 2000):
            points = o + share * t[:, None] * d
            assert (side * (points[:, 2] - 0.4 - water.height(points[:, :2])) > 0).all()


def normals_are_those_of_the_heights(rng):
    water = waves(True)
    xy, normal = rng.uniform(-5, 5, (500, 2)), None
    normal = water.normal(xy)
    for axis in np.eye(2):
        slope = (water.height(xy + 1e-5 * axis) - water.height(xy - 1e-5 * axis)) / 2e-5
        assert np.allclose(-normal[:, :2] @ axis / normal[:, 2], slope, atol=1e-8)


def still_water_is_flat_and_shows_points_where_they_appear(rng):
    """What a ray through a plane hits appears, by the crossing, on that ray."""
    floor = Triangles(box((-60, -60, -2), (60, 60, 9)), np.zeros(12, dtype=int))
    for displaced in (False, True):
        tracer = Tracer(floor, waves(displaced, amplitude=0.0))
        eye = np.array([0.3, -0.2, 2.1])
        directions = unit(np.hstack([rng.normal(size=(500, 2)), rng.uniform(-1, -0.3, (500, 1))]))
        path = tracer.follow(eye, directions, np.zeros(500))
        assert path.water_first.all() and not path.undefined.any() and (path.object == 0).all()
        across = np.linalg.norm(path.point[:, :2] - eye[:2], axis=1)
        x = crossing(1.7, 0.4 - path.point[:, 2], across, 1.0, 1.333)
        sine = np.hypot(directions[:, 0], directions[:, 1])
        assert np.allclose(x / np.hypot(x, 1.7), sine, atol=1e-12)


def small_waves_bring_both_geometries_together(rng):
    floor = Triangles(box((-60, -60, -2), (60, 60, 9)), np.zeros(12, dtype=int))
    eye = np.array([0.3, -0.2, 2.1])
    directions = unit(np.hstack([rng.normal(size=(500, 2)), rng.uniform(-2, -1, (500, 1))]))
    apart = []
    for amplitude in (1e-3, 1e-4):
        ends = []
        for displaced in (False, True):
            tracer = Tracer(floor, waves(displaced, amplitude))
            ends.append(tracer.follow(eye, directions, np.zeros(500)).point)
        apart.append(np.abs(ends[0] - ends[1]).max())
    assert 0 < apart[1] < 0.2 * apart[0]


def main():
    laws = [
        snells_law_holds_and_light_can_go_back,
        the_crossing_takes_the_least_time,
        triangles_are_hit_where_they_are_aimed_at,
        no_ray_leaves_a_closed_box,
        rays_stop_at_the_first_wave,
        normals_are_those_of_the_heights,
        still_water_is_flat_and_shows_points_where_they_appear,
        small_waves_bring_both_geometries_together,
    ]
    for law in laws:
        law(np.random.default_rng(2020))
        print(f"ok  {law.__name__.replace('_', ' ')}")
    return 0
