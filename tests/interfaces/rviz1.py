"""Our RViz configuration with the class names of RViz 1, which Debian has, looking at the middle of what is shown:
rviz1.py CONFIGURATION SHOWN.json."""

import json
import re
import sys

import yaml

# Displays that both versions know by the same fields but for the topic's; TF has no source here.
TOPICS = {"Grid": None, "MarkerArray": "Marker Topic", "Path": "Topic", "Image": "Image Topic", "PointCloud2": "Topic"}

text = re.sub(r"rviz_(default_plugins|common)/", "rviz/", open(sys.argv[1]).read())
config = yaml.safe_load(text)
manager = config["Visualization Manager"]
manager["Displays"] = [d for d in manager["Displays"] if d["Class"].split("/")[1] in TOPICS]
for display in manager["Displays"]:
    if "Topic" in display:
        display[TOPICS[display["Class"].split("/")[1]]] = display.pop("Topic")["Value"]
manager.pop("Transformation")
manager["Global Options"]["Default Light"] = True
places = [m["position"] for m in json.load(open(sys.argv[2]))["markers"] if m["ns"] == "objects"]
view = manager["Views"]["Current"]
view["Focal Point"] = {axis: sum(p[i] for p in places) / len(places) for i, axis in enumerate("XYZ")}
# Wide enough to be read; the image is docked below the list of displays.
config["Window Geometry"].update({"Width": 1400, "Height": 900, "Hide Left Dock": False, "Hide Right Dock": True})
print(yaml.safe_dump(config))
