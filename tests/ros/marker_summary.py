"""What a MarkerArray says, to be compared with a replay's."""

from visualization_msgs.msg import Marker


def summary(markers):
    ellipsoids, labels, stamp = {}, {}, None
    for m in markers.markers:
        assert m.header.frame_id == "map"
        if m.action != Marker.ADD:
            continue
        stamp = [m.header.stamp.sec, m.header.stamp.nanosec]
        if m.ns == "objects":
            assert m.type in (Marker.CUBE, Marker.CYLINDER, Marker.SPHERE, Marker.TRIANGLE_LIST) and 0.0 < m.color.a <= 1.0
            p, q, s = m.pose.position, m.pose.orientation, m.scale
            numbers = [p.x, p.y, p.z, q.x, q.y, q.z, q.w, s.x, s.y, s.z]
            ellipsoids[str(m.id)] = [f"{v:.9f}" for v in numbers]
        elif m.ns == "labels":
            labels[str(m.id)] = m.text
    return {"stamp": stamp, "ellipsoids": ellipsoids, "labels": labels}
