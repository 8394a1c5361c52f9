using Haptolith;
using Unity.Collections;
using UnityEngine;

/// <summary>
/// Draws a bed of soil and a tool, below this object. The scene's device moves the tool, on a thread of the library. Alternatively
/// the tool is an object that is moved in Unity, and the soil is stepped once per frame.
/// </summary>
public sealed class BedAndTool : MonoBehaviour
{
  // Maximum number of instances of Graphics.DrawMeshInstanced.
  const int LargestBatch = 1023;

  // A longer frame slows the soil down instead of making the next frame longer.
  const int MostTicks = 50;

  [Tooltip("A built-in scene, or a scene file.")]
  public string SceneName = "icra2021";

  [Tooltip("Keys of the scene, table.key=value.")]
  public string[] Overrides = { "soil.preset=P3" };

  [Tooltip("What shows the tool, a child of this object.")]
  public Transform Tool;

  [Tooltip("On: the tool goes where Tool is. Off: Tool shows where the scene's device has the tool.")]
  public bool ToolIsMovedInUnity;

  [Tooltip("Must allow GPU instancing.")]
  public Material GrainMaterial;

  [Tooltip("What the soil did to the tool in the last frame, N, Unity's axes.")]
  public Vector3 Force_N;

  Scene scene_;
  Loop loop_;
  NativeArray<Vector3> positions_m_;
  Matrix4x4[] batch_;
  Mesh ball_;
  float diameter_m_;
  double tick_s_;

  // Everything is created here and released in OnDisable(), so that nothing remains when the editor reloads its scripts.
  void OnEnable()
  {
    scene_ = Scene.FromFile(SceneName, Overrides);
    hapto_scene_info info = scene_.Info;
    diameter_m_ = 2 * (float)info.radius_m;
    tick_s_ = info.tick_s;
    positions_m_ = new NativeArray<Vector3>((int)info.particles, Allocator.Persistent);
    batch_ = new Matrix4x4[LargestBatch];
    GameObject ball = GameObject.CreatePrimitive(PrimitiveType.Sphere);
    ball_ = ball.GetComponent<MeshFilter>().sharedMesh;
    Destroy(ball);
    ShowTool(scene_.ToolPose.Position_m, scene_.ToolPose.Orientation);
    if (!ToolIsMovedInUnity)
    {
      loop_ = new Loop(scene_);
      loop_.Start();
    }
  }

  void OnDisable()
  {
    if (loop_ != null)
    {
      loop_.Dispose();
      loop_ = null;
    }
    if (scene_ != null)
    {
      scene_.Dispose();
      scene_ = null;
    }
    if (positions_m_.IsCreated)
    {
      positions_m_.Dispose();
    }
  }

  void Update()
  {
    try
    {
      DrawGrains(loop_ != null ? Watch() : Dig());
    }
    catch (HaptolithException error)
    {
      Debug.LogError(error.Message, this);
      enabled = false;
    }
  }

  /// <summary>Shows the loop's current state.</summary>
  int Watch()
  {
    LoopSnapshot now = loop_.Poll();
    if (now.Particles == 0)
    {
      return 0;
    }
    ShowTool(now.Scene_T_Tool.Position_m, now.Scene_T_Tool.Orientation);
    Force_N = UnityFrame.ToUnityForce(now.SoilWrench.Force_N);
    return loop_.CopyPositions(positions_m_);
  }

  /// <summary>Moves the tool to its object's pose, in the number of ticks of the frame's duration.</summary>
  int Dig()
  {
    int ticks = Mathf.Clamp(Mathf.RoundToInt((float)(Time.deltaTime / tick_s_)), 1, MostTicks);
    Wrench felt = scene_.MoveTool(UnityFrame.FromUnity(Tool.localPosition, Tool.localRotation), ticks);
    Force_N = UnityFrame.ToUnityForce(felt.Force_N);
    return scene_.CopyPositions(positions_m_);
  }

  void ShowTool(Vec3 position_m, Quat orientation)
  {
    Tool.localPosition = UnityFrame.ToUnityPosition(position_m);
    Tool.localRotation = UnityFrame.ToUnityRotation(orientation);
  }

  void DrawGrains(int count)
  {
    Matrix4x4 world_T_bed = transform.localToWorldMatrix;
    Vector3 size_m = new Vector3(diameter_m_, diameter_m_, diameter_m_);
    for (int first = 0; first < count; first += LargestBatch)
    {
      int many = Mathf.Min(LargestBatch, count - first);
      for (int i = 0; i < many; ++i)
      {
        batch_[i] = world_T_bed * Matrix4x4.TRS(positions_m_[first + i], Quaternion.identity, size_m);
      }
      Graphics.DrawMeshInstanced(ball_, 0, GrainMaterial, batch_, many);
    }
  }
}
