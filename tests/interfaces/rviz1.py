"""Our RViz configuration with the class names of RViz 1, which Debian has: rviz1.py FILE."""

import re
import sys

import yaml

# Displays that both versions know by the same fields; TF has no source here.
SHARED = ("Grid", "MarkerArray")

text = re.sub(r"rviz_(default_plugins|common)/", "rviz/", open(sys.argv[1]).read())
config = yaml.safe_load(text)
manager = config["Visualization Manager"]
manager["Displays"] = [d for d in manager["Displays"] if d["Class"].split("/")[1] in SHARED]
for display in manager["Displays"]:
    if "Topic" in display:
        display["Marker Topic"] = display.pop("Topic")["Value"]
manager.pop("Transformation")
manager["Global Options"]["Default Light"] = True
print(yaml.safe_dump(config))
