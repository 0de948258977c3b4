//! Arguments of ROS 2, and parameters by name.

use ellipsoid_slam::config::{
    DetectionsType, LogLevel, Parameters, RosArguments, key_of, keys, parameters_from_yaml,
};
use serde_json::{Value, json};

fn parse(line: &str) -> Result<(RosArguments, Vec<String>), String> {
    let words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
    RosArguments::parse(&words, "ellipsoid_slam").map_err(|e| e.to_string())
}

fn parsed(line: &str) -> RosArguments {
    parse(line).unwrap().0
}

/// Parameters after a command line; files are named by what they contain.
fn parameters(line: &str, files: &[(&str, &str)]) -> Result<(Parameters, Vec<String>), String> {
    let mut parameters = Parameters::default();
    let read = |path: &str| {
        files.iter().find(|f| f.0 == path).map(|f| f.1.to_owned()).ok_or("no such file")
    };
    let without = parsed(line).apply(&mut parameters, read).map_err(|e| e.to_string())?;
    Ok((parameters, without))
}

#[test]
fn arguments_of_ros_are_told_from_the_others() {
    let (ros, others) = parse(
        "--rate 2 --ros-args -r __ns:=/robot1 -r __node:=mapper -- --loop --ros-args --log-level debug --log-level \
         tf:=WARN -e /enclave --disable-stdout-logs",
    )
    .unwrap();
    assert_eq!(others, ["--rate", "2", "--loop"]);
    assert_eq!((ros.node(), ros.namespace()), ("mapper", "/robot1"));
    assert_eq!(ros.full_name(), "/robot1/mapper");
    assert_eq!(ros.log_level("tf"), Some(LogLevel::Warn));
    assert_eq!(ros.log_level("mapper"), Some(LogLevel::Debug));
    let (ros, others) = parse("-r 3 --params-file x").unwrap();
    assert_eq!(others.len(), 4, "before `--ros-args` nothing is ROS 2's");
    assert_eq!((ros.full_name().as_str(), ros.log_level("x")), ("/ellipsoid_slam", None));
}

#[test]
fn topics_are_remapped_as_rcl_does_it() {
    let ros = parsed(
        "--ros-args -r __ns:=/robot1 -r odom:=/wheel/odom -r depth/image:=camera/depth -r ~/markers:=/markers -r \
         other:detections:=boxes -r ellipsoid_slam:detections:=yolo/boxes -r odom:=second -r /tf:=tf",
    );
    for (name, resolved) in [
        ("odom", "/wheel/odom"),
        ("/robot1/odom", "/wheel/odom"),
        ("/odom", "/odom"),
        ("depth/image", "/robot1/camera/depth"),
        ("~/markers", "/markers"),
        ("~/path", "/robot1/ellipsoid_slam/path"),
        ("detections", "/robot1/yolo/boxes"),
        ("/tf", "/robot1/tf"),
    ] {
        assert_eq!(ros.resolve(name), resolved, "{name}");
    }
    assert_eq!(parsed("").resolve("odom"), "/odom");
    assert_eq!(parsed("--ros-args -r __ns:=/").full_name(), "/ellipsoid_slam");
    assert_eq!(parsed("--ros-args -r rostopic://odom:=a/odom").resolve("odom"), "/a/odom");
}

#[test]
fn what_is_wrong_is_named() {
    for (line, words) in [
        ("--ros-args --colour", "`--colour` is no argument"),
        ("--ros-args -p", "`-p` needs a value"),
        ("--ros-args -p sync.slop_s=1", "name:=value"),
        ("--ros-args -r a:=", "from:=to"),
        ("--ros-args -r __ns:=/1st", "`/1st` is not a name"),
        ("--ros-args -r a:=b//c", "is not a name"),
        ("--ros-args --log-level loud", "debug, info"),
    ] {
        let error = parse(line).unwrap_err();
        assert!(error.contains(words), "{line}: {error}");
    }
    for (line, words) in [
        ("--ros-args --params-file gone.yaml", "cannot read the parameter file gone.yaml"),
        ("--ros-args -p snyc.slop_s:=1", "did you mean `sync.slop_s`"),
        ("--ros-args -p sync.slop_s:=5.0", "not between 0 and 1"),
        ("--ros-args -p sync:=5.0", "`sync` is a section"),
    ] {
        let error = parameters(line, &[]).unwrap_err();
        assert!(error.contains(words), "{line}: {error}");
    }
}

#[test]
fn later_arguments_win_and_sections_are_for_their_node() {
    let all = "/**:\n  ros__parameters:\n    use_sim_time: true\n    others_gain: 3\n    sync: {slop_s: 0.1}\n";
    let own = "robot1:\n  ellipsoid_slam:\n    ros__parameters:\n      sync.slop_s: 0.2\nellipsoid_slam:\n  ros__parameters:\n    sync: {slop_s: 0.9}\n";
    let files = [("all", all), ("own", own)];
    let slop =
        |line: &str| parameters(line, &files).map(|(p, without)| (p.slam.sync.slop_s, without));
    let line = "--ros-args -r __ns:=/robot1 --params-file own --params-file all";
    assert_eq!(slop(line), Ok((0.1, vec![])));
    let line = "--ros-args -r __ns:=/robot1 --params-file all --params-file own";
    assert_eq!(slop(line), Ok((0.2, vec![])));
    assert_eq!(slop("--ros-args --params-file own -p sync.slop_s:=0.3"), Ok((0.3, vec![])));
    assert_eq!(slop("--ros-args -p sync.slop_s:=0.3 --params-file own"), Ok((0.9, vec![])));
    assert_eq!(slop("--ros-args -p other:sync.slop_s:=0.3"), Ok((0.02, vec![])));
    let line = "--ros-args -r __ns:=/robot2 --params-file own";
    assert_eq!(slop(line), Ok((0.02, vec!["own".to_owned()])), "a file for another node");
    assert!(parameters("--ros-args --params-file all", &files).unwrap().0.node.use_sim_time);
}

#[test]
fn values_are_typed_as_yaml_1_1_types_them() {
    let line = "--ros-args -p publish.cuboids:=yes -p publish_tf:=Off -p map_frame:=world -p sync.max_waiting:=7 -p \
                publish.path_step_m:=1 -p topics.detections_type:=yolo_msgs";
    let (got, _) = parameters(line, &[]).unwrap();
    assert!(got.node.publish.cuboids && !got.node.publish_tf);
    assert_eq!((got.node.map_frame.as_str(), got.slam.sync.max_waiting), ("world", 7));
    assert_eq!(got.node.publish.path_step_m, 1.0);
    assert_eq!(got.node.topics.detections_type, DetectionsType::YoloMsgs);
}

#[test]
fn setting_a_parameter_is_the_same_as_a_file_with_that_key() {
    let cases = [
        ("sync.slop_s", json!(0.25)),
        ("perception.fit", json!("quadric")),
        ("perception.classes.listed.cup.size_m", json!([0.1, 0.1, 0.2])),
        ("perception.classes.listed.robot vacuum.outline", json!("cylinder")),
        ("publish.cuboids", json!(true)),
    ];
    for (name, value) in cases {
        let mut set = Parameters::default();
        set.set(name, value.clone()).unwrap();
        let nested = name.rsplit('.').fold(value.clone(), |inner, part| json!({part: inner}));
        let file = json!({"ellipsoid_slam": {"ros__parameters": nested}}).to_string();
        assert_eq!(parameters_from_yaml(&file).unwrap(), set, "{name}");
        assert_ne!(set, Parameters::default(), "{name}");
        assert_eq!(set.get(name).unwrap(), Some(value));
    }
    let mut parameters = Parameters::default();
    for (name, value) in [("slam.kernel", json!("soft")), ("sync.slop_s", json!("wide"))] {
        assert!(parameters.set(name, value).is_err());
        assert_eq!(parameters, Parameters::default(), "nothing has changed");
    }
}

#[test]
fn all_parameters_are_listed_with_what_they_mean() {
    let parameters = Parameters::default();
    let all = parameters.list().unwrap();
    assert_eq!(all[0].name, "use_sim_time");
    let find = |name: &str| all.iter().find(|p| p.name == name).unwrap();
    assert_eq!(find("sync.slop_s").value, json!(0.02));
    assert_eq!(find("sync.slop_s").key.range, Some(0.0..=1.0));
    assert!(find("sync.slop_s").key.live && !find("topics.depth").key.live);
    assert_eq!(find("perception.classes.listed.cup.symmetry").key.path, "perception.classes");
    for parameter in &all {
        assert!(!matches!(parameter.value, Value::Object(_) | Value::Null), "{}", parameter.name);
        assert_eq!(parameters.get(&parameter.name).unwrap().as_ref(), Some(&parameter.value));
    }
    assert_eq!(parameters.get("sync").unwrap(), None, "a section is no parameter");
    assert!(key_of("perception.klasses").is_none());
    assert!(keys().all(|key| !key.meaning.is_empty()));
}

#[test]
fn what_counts_only_at_the_start_is_named() {
    let (mut changed, was) = (Parameters::default(), Parameters::default());
    changed.set("sync.slop_s", json!(0.5)).unwrap();
    assert_eq!(was.first_fixed_difference(&changed).unwrap(), None);
    changed.set("topics.depth", json!("other")).unwrap();
    assert_eq!(was.first_fixed_difference(&changed).unwrap().as_deref(), Some("topics.depth"));
}
