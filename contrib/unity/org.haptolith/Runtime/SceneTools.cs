using System;
using System.Runtime.InteropServices;

namespace Haptolith
{
  /// <summary>The tools of a scene, by their numbers from 0 on. Members without a number act on the first tool.</summary>
  public sealed unsafe partial class Scene
  {
    /// <summary>Number of tools.</summary>
    public int ToolCount
    {
      get
      {
        uint count;
        using (Borrowed scene = new Borrowed(handle_))
        {
          Check.RequireOfTick(Native.hapto_scene_tools(scene.Address, &count));
        }
        return (int)count;
      }
    }

    /// <summary>Returns a tool's name in the scene file.</summary>
    public string ToolName(int tool)
    {
      byte* name;
      using (Borrowed scene = new Borrowed(handle_))
      {
        Check.RequireOfTick(Native.hapto_scene_tool_name(scene.Address, Number(tool), &name));
        return Marshal.PtrToStringAnsi((IntPtr)name);
      }
    }

    /// <summary>Returns the number of the tool with a name.</summary>
    public int FindTool(string name)
    {
      uint tool;
      fixed (byte* text = Text.Bytes(name))
      using (Borrowed scene = new Borrowed(handle_))
      {
        Check.Require(Native.hapto_scene_find_tool(scene.Address, text, &tool));
      }
      return (int)tool;
    }

    /// <summary>
    /// Runs one tick of 1 ms with a pose for each tool; felt receives the soil wrench of each, scene frame. Twists and felt may be
/// null. Nothing moves when a pose is not valid.
    /// </summary>
    public void StepTools(Pose[] poses, Wrench[] felt, Twist[] twists = null)
    {
      if ((felt != null && felt.Length < poses.Length) || (twists != null && twists.Length < poses.Length))
      {
        throw new ArgumentException("there are fewer wrenches or twists than poses");
      }
      int tools = ToolCount;
      if (poses.Length != tools)
      {
        throw new ArgumentException("a scene with " + tools + " tools needs " + tools + " poses, not " + poses.Length);
      }
      fixed (Pose* to = poses)
      fixed (Twist* moving = twists)
      fixed (Wrench* from = felt)
      {
        StepTools(to, moving, from, poses.Length);
      }
    }

    /// <summary>As above for memory such as a NativeArray's; count is the number of tools.</summary>
    public void StepTools(Pose* poses, Twist* twists, Wrench* felt, int count)
    {
      using (Borrowed scene = new Borrowed(handle_))
      {
        Check.RequireOfTick(Native.hapto_scene_step_tools(scene.Address, (hapto_pose*)poses, (hapto_twist*)twists,
                                                          Number(count), (hapto_wrench*)felt));
      }
    }

    /// <summary>Places a tool at a pose without moving it there; the pose should be above the soil.</summary>
    public void PlaceTool(int tool, Pose scene_T_tool)
    {
      using (Borrowed scene = new Borrowed(handle_))
      {
        Check.RequireOfTick(Native.hapto_scene_tool_place(scene.Address, Number(tool), (hapto_pose*)&scene_T_tool));
      }
    }

    /// <summary>Sets the speed (rad/s) or the torque (N m) of the drive of a tool's joint from the next tick on.</summary>
    public void SetDrive(int tool, double value)
    {
      using (Borrowed scene = new Borrowed(handle_))
      {
        Check.RequireOfTick(Native.hapto_scene_tool_set_drive(scene.Address, Number(tool), value));
      }
    }

    /// <summary>Opening of a tool's jaws at the end of the next tick, 0 to 1.</summary>
    public void SetOpening(int tool, double share)
    {
      using (Borrowed scene = new Borrowed(handle_))
      {
        Check.RequireOfTick(Native.hapto_scene_tool_set_opening(scene.Address, Number(tool), share));
      }
    }

    /// <summary>Sets the factor on a tool's contact stiffness, 0 to 1, from the next tick on.</summary>
    public void SetToolFade(int tool, double share)
    {
      using (Borrowed scene = new Borrowed(handle_))
      {
        Check.RequireOfTick(Native.hapto_scene_tool_set_fade(scene.Address, Number(tool), share));
      }
    }

    /// <summary>Returns pose, soil wrench, joint and stiffness of a tool, as in C.</summary>
    public hapto_tool_state ToolState(int tool)
    {
      hapto_tool_state state = new hapto_tool_state { size = (uint)sizeof(hapto_tool_state) };
      using (Borrowed scene = new Borrowed(handle_))
      {
        Check.RequireOfTick(Native.hapto_scene_tool_get_state(scene.Address, Number(tool), &state));
      }
      return state;
    }

    static uint Number(int tool)
    {
      if (tool < 0)
      {
        throw new ArgumentOutOfRangeException("tool", tool, "must not be negative");
      }
      return (uint)tool;
    }
  }
}
