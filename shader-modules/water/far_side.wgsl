// What stands on the other side of the water than the camera. World space, metres.
//
// provides: side
// needs: water/body
// slots: level

fn side(point: vec3f) -> bool {
    return water.camera_side * (point.z - level(point.xy)) < 0.0;
}
