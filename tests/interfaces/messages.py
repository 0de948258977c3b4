"""Our interfaces as Python sees them: imported, filled in, and through the wire format and back."""

import math

from ellipsoid_slam.msg import EllipsoidMeasurement, EllipsoidMeasurementArray, LabelBelief, Object, ObjectArray
from ellipsoid_slam.srv import AddObject, ApproachObject, DeleteObject, LoadMap, LockObject, QueryObjects, RenameObject, SaveMap
from rclpy.serialization import deserialize_message, serialize_message

cup = Object(id=7, label="cup", name="mug", locked=True, existence=0.9, observations=3, outline=Object.CYLINDER, support_height=math.inf)
cup.labels = [LabelBelief(label="cup", probability=0.75), LabelBelief(label="bowl", probability=0.25)]
cup.pose.position.x, cup.semi_axes.z, cup.covariance[10] = 1.5, 0.05, 0.25
objects = ObjectArray(objects=[cup])
objects.header.frame_id = "map"
measured = EllipsoidMeasurement(object_id=7, detection_probability=0.5)
measured.sides[2] = EllipsoidMeasurement.HIDDEN
query = QueryObjects.Request(labels=["cup"], in_region=True, max_count=2)
for message in [
    objects,
    EllipsoidMeasurementArray(measurements=[measured], support_heights=[0.0, 0.75]),
    query,
    QueryObjects.Response(success=True, ids=[7, 9]),
    SaveMap.Request(path="/tmp/map.json"),
    LoadMap.Response(success=True, objects=7),
    ApproachObject.Request(label="chair", distance=0.5),
    RenameObject.Request(id=7, name="mug"),
    LockObject.Request(id=7, locked=True),
    DeleteObject.Request(id=7),
    AddObject.Request(label="chair"),
]:
    again = deserialize_message(serialize_message(message), type(message))
    assert again == message, (again, message)
assert (Object.ELLIPSOID, Object.CUBOID, Object.CYLINDER, Object.SUPERQUADRIC) == (0, 1, 2, 3)
print("the interfaces import and go through the wire format")
