// The view that a pass draws.
//
// needs: screen/camera

var<uniform> view_target: View;
