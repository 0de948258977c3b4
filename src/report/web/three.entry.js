export {
  AmbientLight, BoxGeometry, BufferAttribute, BufferGeometry, CanvasTexture, Color, CylinderGeometry, DirectionalLight, DoubleSide,
  DynamicDrawUsage, EdgesGeometry, Float32BufferAttribute, Group, HemisphereLight, InstancedBufferAttribute, InstancedBufferGeometry,
  InstancedMesh, Line, LineBasicMaterial, LineSegments, Matrix3, Matrix4, Mesh, MeshBasicMaterial, MeshLambertMaterial,
  OrthographicCamera, PerspectiveCamera, PlaneGeometry, Points, PointsMaterial, Quaternion, RawShaderMaterial, Ray, Raycaster, Scene, ShaderMaterial,
  SphereGeometry, SRGBColorSpace, Texture, Vector2, Vector3, WebGLRenderer,
} from "three";
export { OrbitControls } from "three/addons/controls/OrbitControls.js";
