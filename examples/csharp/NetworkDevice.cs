// Leads haptolith's tool along a circle through its network device, and prints the force that a hand would feel.
//
//     haptolith run --device network                                                    in one terminal
//     mcs examples/csharp/NetworkDevice.cs -out:circle.exe && mono circle.exe           in another
//
// circle.exe [ADDRESS [SECONDS [HEIGHT_MM]]], default 127.0.0.1:9050, 10 s and -90 mm. The height of the circle is in the
// device's frame, whose origin is 85 mm above the soil. It needs only .NET's library, and does not support keys. The packets
// are those of include/haptolith/network_device.h; their offsets are in docs/reference/udp.md.

using System;
using System.Diagnostics;
using System.Globalization;
using System.IO;
using System.Net;
using System.Net.Sockets;
using System.Threading;

static class NetworkDevice
{
    const int PacketBytes = 136, AnswerBytes = 80;
    const ushort Version = 1;
    const ushort Held = 1;                // flag of sent packets: the dead-man switch
    const ushort Live = 1, Tripped = 2;     // flags of answers
    const double Silence_ms = 20;         // time without answers after which the force must be zero
    const double Radius_m = 0.02;
    const double Turn_rad_s = Math.PI / 2;

    struct Answer
    {
        public ushort Flags;
        public ulong SenderTime_us;
        public double X_n, Y_n, Z_n;

        public double Strength_n { get { return Math.Sqrt(X_n * X_n + Y_n * Y_n + Z_n * Z_n); } }
        public string State { get { return (Flags & Tripped) != 0 ? "tripped" : (Flags & Live) != 0 ? "live" : "not held"; } }
    }

    // Packet with the tool's pose and velocity after t_s. BinaryWriter is little-endian on every machine.
    static byte[] Packet(uint sequence, ulong time_us, double t_s, double height_m)
    {
        double c = Math.Cos(Turn_rad_s * t_s), s = Math.Sin(Turn_rad_s * t_s);
        var bytes = new MemoryStream(PacketBytes);
        var writer = new BinaryWriter(bytes);
        writer.Write(new[] { (byte)'H', (byte)'L', (byte)'D', (byte)'V' });
        writer.Write(Version);
        writer.Write(Held);
        writer.Write(sequence);
        writer.Write(0u); // buttons
        writer.Write(time_us);
        double[] numbers = {
            Radius_m * c, Radius_m * s, height_m,                              // position, m
            1, 0, 0, 0,                                                        // orientation, w x y z
            -Radius_m * Turn_rad_s * s, Radius_m * Turn_rad_s * c, 0,          // velocity, m/s
            0, 0, 0,                                                           // angular velocity, rad/s
            0,                                                                 // gripper, closed
        };
        foreach (double number in numbers) writer.Write(number);
        return bytes.ToArray();
    }

    // Parses an answer; null for any other packet.
    static Answer? Read(byte[] bytes)
    {
        var reader = new BinaryReader(new MemoryStream(bytes));
        if (bytes.Length != AnswerBytes || new string(reader.ReadChars(4)) != "HLAN" || reader.ReadUInt16() != Version)
            return null;
        var answer = new Answer { Flags = reader.ReadUInt16() };
        reader.ReadUInt64(); // sequence and number
        answer.SenderTime_us = reader.ReadUInt64();
        answer.X_n = reader.ReadDouble();
        answer.Y_n = reader.ReadDouble();
        answer.Z_n = reader.ReadDouble();
        return answer; // torque and gripper force follow
    }

    // Returns the newest received answer, or null.
    static Answer? NewestAnswer(UdpClient udp)
    {
        Answer? newest = null;
        var from = new IPEndPoint(IPAddress.Any, 0);
        while (udp.Available > 0) newest = Read(udp.Receive(ref from)) ?? newest;
        return newest;
    }

    // Windows sleeps 15 ms instead of 1 ms, which is close to the limit without answers.
    static void WaitUntil(Stopwatch clock, double time_ms)
    {
        bool coarse = Environment.OSVersion.Platform == PlatformID.Win32NT;
        while (clock.Elapsed.TotalMilliseconds < time_ms)
        {
            if (coarse) Thread.Yield();
            else Thread.Sleep(1);
        }
    }

    static int Main(string[] arguments)
    {
        CultureInfo.CurrentCulture = CultureInfo.InvariantCulture;
        string[] address = (arguments.Length > 0 ? arguments[0] : "127.0.0.1:9050").Split(':');
        double seconds = arguments.Length > 1 ? double.Parse(arguments[1]) : 10;
        double height_m = (arguments.Length > 2 ? double.Parse(arguments[2]) : -90) / 1000;

        uint sequence = 0;
        int answers = 0;
        double strongest_n = 0, printed_ms = 0, answered_ms = 0;
        var felt = new Answer();
        var clock = Stopwatch.StartNew();
        using (var udp = new UdpClient(address[0], int.Parse(address[1])))
        {
            try
            {
                while (clock.Elapsed.TotalSeconds < seconds)
                {
                    double now_ms = clock.Elapsed.TotalMilliseconds;
                    byte[] packet = Packet(sequence++, (ulong)(now_ms * 1e3), now_ms / 1e3, height_m);
                    udp.Send(packet, packet.Length);
                    Answer? answer = NewestAnswer(udp);
                    if (answer != null)
                    {
                        felt = answer.Value;
                        answered_ms = now_ms;
                        ++answers;
                        strongest_n = Math.Max(strongest_n, felt.Strength_n);
                    }
                    else if (now_ms - answered_ms > Silence_ms)
                    {
                        felt = new Answer(); // a device that pushes a hand must be sent zero force here
                    }
                    if (answer != null && now_ms - printed_ms > 100)
                    {
                        printed_ms = now_ms;
                        double round_trip_ms = clock.Elapsed.TotalMilliseconds - felt.SenderTime_us / 1e3;
                        Console.WriteLine("force {0,7:F3} {1,7:F3} {2,7:F3} N  round trip {3,6:F2} ms  {4}", felt.X_n, felt.Y_n,
                            felt.Z_n, round_trip_ms, felt.State);
                    }
                    WaitUntil(clock, now_ms + 1);
                }
            }
            catch (SocketException)
            {
                // The port is not open, which the system reports at the next packet.
            }
        }
        if (answers == 0)
        {
            Console.Error.WriteLine("nobody answers: start `haptolith run --device network` first, or name its address");
            return 1;
        }
        Console.WriteLine("{0} packets sent, {1} answers, strongest force {2:F3} N", sequence, answers, strongest_n);
        return 0;
    }
}
