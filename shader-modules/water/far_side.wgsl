// What stands on the other side of the water than the camera. World space, metres.
//
// provides: side
// needs: water/body
// slots: level
// domain: side(point -1e4 to 1e4 from 1e-6)

fn side(point: vec3f) -> bool {
    let height = point.z - water.level;
    // Beyond what the waves reach, the rest plane decides.
    if abs(height) > water.height_bound {
        return water.camera_side * height < 0.0;
    }
    return water.camera_side * (point.z - level(point.xy)) < 0.0;
}
