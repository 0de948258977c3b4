//! Where a node's maps are: what other programs may name, and where that is on the disk.

use crate::{
    config::MapFileSettings,
    io::{load_saved_map, save_maps},
    mapping::SavedMap,
    pipeline::{LOCAL_MAP, MapsToSave, SET_ASIDE_MAP},
};
use std::{
    fs,
    path::{Path, PathBuf},
};

/// The map's file, and the folder in which services load and save others by name.
pub(super) struct MapFolder {
    file: Option<PathBuf>,
    folder: Option<PathBuf>,
}

impl MapFolder {
    /// Where a link is given, whoever starts the node means the file that it points to.
    pub(super) fn new(settings: &MapFileSettings) -> Self {
        let given = |path: &str| (!path.is_empty()).then(|| PathBuf::from(path));
        let file = given(&settings.file).map(|file| fs::canonicalize(&file).unwrap_or(file));
        let beside = || file.as_ref().map(|file| file.parent().unwrap_or(Path::new("")).to_owned());
        let folder = given(&settings.directory).or_else(beside);
        Self { file, folder }
    }

    /// The map of a name; of an empty one, the map's file.
    pub(super) fn load(&self, name: &str) -> Result<SavedMap, String> {
        let path = self.path(name)?;
        load_saved_map(&path).map_err(|why| format!("{}: {why}", path.display()))
    }

    /// Saves maps under a name, or in the map's file; what was done.
    pub(super) fn save(&self, name: &str, maps: &MapsToSave) -> Result<String, String> {
        let path = self.path(name)?;
        let beside = save_maps(&path, maps).map_err(|why| format!("{}: {why}", path.display()))?;
        let (count, file) = (maps.map.objects.len(), path.display());
        let (Some(beside), Some((name, other))) = (beside, &maps.beside) else {
            return Ok(format!("{count} objects saved in {file}"));
        };
        let (beside, others) = (beside.display(), other.objects.len());
        Ok(match (*name, &maps.why) {
            (LOCAL_MAP, Some(why)) => format!(
                "the place in the loaded map was not recognised ({why}): that map is saved in {file} as it was, \
                 and {others} objects seen since in {beside}"
            ),
            (SET_ASIDE_MAP, _) => format!(
                "{count} objects saved in {file}, and the {others} of the loaded map, whose place was not recognised, \
                 in {beside}"
            ),
            _ => format!("{count} objects saved in {file}, and {others} in {beside}"),
        })
    }

    /// A peer gives the name of a map, never a path: it must not reach what else the user of the node may write.
    fn path(&self, name: &str) -> Result<PathBuf, String> {
        if name.is_empty() {
            let none = "no name was given, and the parameter map.file is empty";
            return self.file.clone().ok_or_else(|| none.into());
        }
        let is_name = name.ends_with(".json")
            && !name.starts_with('.')
            && name.len() <= MOST_BYTES
            && name.chars().all(|c| c.is_alphanumeric() || "._- ".contains(c));
        if !is_name {
            return Err(format!(
                "{name:.64?} is no name of a map: letters, digits, `_`, `-`, spaces and dots, with .json at the end; \
                 the parameter map.directory says in which folder"
            ));
        }
        match &self.folder {
            Some(folder) => Ok(folder.join(name)),
            None => Err("neither map.directory nor map.file says in which folder maps are".into()),
        }
    }
}

/// Of a name: file systems take 255, and a temporary name is longer.
const MOST_BYTES: usize = 200;
