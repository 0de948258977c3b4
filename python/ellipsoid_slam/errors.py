"""What goes wrong, each with one sentence that says what and where."""


class Error(Exception):
    """Any error of this package."""


class FrameError(Error, ValueError):
    """A camera, a pose, depth or a box that cannot be."""


class SettingsError(Error, ValueError):
    """A setting that does not exist, or cannot have this value."""


class MapError(Error):
    """A file that is no map, a map that cannot be, or one that could not be written."""


class BagError(Error):
    """A bag that cannot be read, or that lacks something."""
