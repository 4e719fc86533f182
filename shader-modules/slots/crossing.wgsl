// Where light between two points crosses flat water. `low`: distance from the plane on the side of
// the lower refractive index, `high`: on the other side, `apart`: horizontal distance; metres, none
// negative. By default two Halley steps, enough for drawing.
//
// needs: optics/flat_crossing

fn crossing(low: f32, high: f32, apart: f32) -> Crossing {
    return flat_crossing(low, high, apart);
}
