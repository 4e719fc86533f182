// The view with which the seen buffers were drawn.
//
// needs: screen/camera

var<uniform> view_seen: View;
