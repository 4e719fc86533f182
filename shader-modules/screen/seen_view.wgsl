// The view with which the seen buffers were drawn: the target's, with a guard band around it.
//
// needs: screen/camera, screen/target

fn view_seen() -> View {
    var view = view_target;
    view.size = view_target.seen_size;
    return view;
}
