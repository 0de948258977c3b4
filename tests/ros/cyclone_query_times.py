"""Asks a node that has too much to do for its objects, again and again. Prints how long answers took."""

import time

from cyclone_messages import QueryObjectsRequest, QueryObjectsResponse
from cyclone_participant import client, wait_for

query = client("query_objects", QueryObjectsRequest, QueryObjectsResponse)
wait_for("an object", lambda: query().ids)
# By now more waits than can be worked off.
time.sleep(3)
times = []
for _ in range(40):
    asked = time.monotonic()
    assert query().success
    times.append(time.monotonic() - asked)
    time.sleep(0.05)
times.sort()
print(f"query_objects under load: median {1e3 * times[20]:.0f} ms, longest {1e3 * times[-1]:.0f} ms")
assert times[-1] < 0.2, times
