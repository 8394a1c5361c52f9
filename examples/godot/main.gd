# Holds haptolith's tool through its network device: leads it along a circle in the soil and displays the force.
#
#     haptolith run icra2021 --device network                         in one terminal
#     godot3-server --path examples/godot                          in another; godot3 also displays it
#
# Options: --address=127.0.0.1:9050 --seconds=10 --height-mm=-90, the circle's height above the handle's origin, which is
# 85 mm above the soil. Exit status 1: no answer, or no force.
extends Spatial

const ANSWER_BYTES = 80
const VERSION = 1
const HELD = 1  # flag of sent packets: the dead-man switch
const SILENCE_MS = 20.0  # time without answers after which the force must be zero
const RADIUS_M = 0.02
const TURN_RAD_S = PI / 2

var host = "127.0.0.1"
var port = 9050
var seconds = 10.0
var height_m = -0.09

# A frame takes 16 ms, which a hand would feel, so the device has a separate thread. Shared data are protected by a lock.
var thread = Thread.new()
var lock = Mutex.new()
var is_over = false
var position_m = Vector3()  # position of the tool, in Godot's frame
var force_n = Vector3()  # force on the hand, in Godot's frame
var sent = 0
var answers = 0
var strongest_n = 0.0
var slowest_ms = 0.0  # maximum round trip


func _ready():
	for argument in OS.get_cmdline_args():
		var words = argument.split("=")
		if words.size() != 2:
			continue
		match words[0]:
			"--address":
				host = words[1].split(":")[0]
				port = int(words[1].split(":")[1])
			"--seconds":
				seconds = float(words[1])
			"--height-mm":
				height_m = float(words[1]) / 1000
	thread.start(self, "hold_tool")


func _process(_delta):
	lock.lock()
	$Tool.translation = position_m
	$Force.text = "%.3f N" % force_n.length()
	var over = is_over
	lock.unlock()
	if over:
		tell_and_quit()


func tell_and_quit():
	set_process(false)
	thread.wait_to_finish()
	print("%d packets sent, %d answers, strongest force %.4f N" % [sent, answers, strongest_n])
	print("longest round trip %.1f ms" % slowest_ms)
	var why = ""
	if answers == 0:
		why = "nobody answers: start `haptolith run --device network` first, or give --address"
	elif strongest_n == 0:
		why = "the tool has felt nothing: is the soil lower than --height-mm?"
	if why != "":
		printerr(why)
	get_tree().quit(0 if why == "" else 1)


# --- on the thread of the device ---------------------------------------------------------------------------------------


func hold_tool(_nothing):
	var udp = PacketPeerUDP.new()
	udp.set_dest_address(host, port)
	var start_us = OS.get_ticks_usec()
	var answered_ms = 0.0
	var t_s = 0.0
	while t_s < seconds:
		t_s = (OS.get_ticks_usec() - start_us) / 1e6
		var angle = TURN_RAD_S * t_s
		var at_m = Vector3(RADIUS_M * cos(angle), height_m, -RADIUS_M * sin(angle))
		var velocity_m_s = RADIUS_M * TURN_RAD_S * Vector3(-sin(angle), 0, -cos(angle))
		udp.put_packet(packet(sent, OS.get_ticks_usec(), at_m, Quat(), velocity_m_s, Vector3()))
		var felt_n = null
		while udp.get_available_packet_count() > 0:
			var told = answer(udp.get_packet())
			if told != null:
				felt_n = told.force_n
				answered_ms = t_s * 1000
				slowest_ms = max(slowest_ms, (OS.get_ticks_usec() - told.sender_time) / 1e3)
		lock.lock()
		sent += 1
		position_m = at_m
		if felt_n != null:
			answers += 1
			force_n = felt_n
			strongest_n = max(strongest_n, felt_n.length())
		elif t_s * 1000 - answered_ms > SILENCE_MS:
			force_n = Vector3()  # a device that pushes a hand must be sent zero force here
		lock.unlock()
		OS.delay_usec(1000)
	lock.lock()
	is_over = true
	lock.unlock()


# The 136 bytes of docs/reference/udp.md; everything is in Godot's frame.
func packet(sequence, time_us, at_m, rotation, velocity_m_s, angular_velocity_rad_s):
	var bytes = StreamPeerBuffer.new()
	bytes.big_endian = false
	bytes.put_data("HLDV".to_ascii())
	bytes.put_u16(VERSION)
	bytes.put_u16(HELD)
	bytes.put_u32(sequence)
	bytes.put_u32(0)  # buttons
	bytes.put_u64(time_us)
	put_vector(bytes, at_m)
	bytes.put_double(rotation.w)
	put_vector(bytes, Vector3(rotation.x, rotation.y, rotation.z))
	put_vector(bytes, velocity_m_s)
	put_vector(bytes, angular_velocity_rad_s)
	bytes.put_double(0)  # gripper: closed
	return bytes.data_array


# Parses the 80 bytes of an answer; null for any other packet.
func answer(data):
	if data.size() != ANSWER_BYTES or data.subarray(0, 3).get_string_from_ascii() != "HLAN":
		return null
	var bytes = StreamPeerBuffer.new()
	bytes.big_endian = false
	bytes.data_array = data
	bytes.seek(4)
	if bytes.get_u16() != VERSION:
		return null
	bytes.seek(16)  # skips flags and numbers
	var sender_time = bytes.get_u64()
	return {"sender_time": sender_time, "force_n": get_vector(bytes)}  # torque and the gripper's force follow


# Godot has y up and views along -z; haptolith has z up and views along y. Both are right-handed, so rotations have equal signs.
func put_vector(bytes, godot):
	bytes.put_double(godot.x)
	bytes.put_double(-godot.z)
	bytes.put_double(godot.y)


func get_vector(bytes):
	var x = bytes.get_double()
	var y = bytes.get_double()
	var z = bytes.get_double()
	return Vector3(x, z, -y)
