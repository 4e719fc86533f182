// A ray behind the water.
//
// needs: geometry/ray

// `total`: the water reflects all light; the ray stays on the camera's side then.
struct Deflected {
    ray: Ray,
    total: bool,
}
