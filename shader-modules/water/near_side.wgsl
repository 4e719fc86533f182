// What stands on the camera's side of the water. World space, metres.
//
// provides: side
// needs: water/body
// slots: level

fn side(point: vec3f) -> bool {
    return water.camera_side * (point.z - level(point.xy)) >= 0.0;
}
