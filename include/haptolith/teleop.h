/* Packets between an operator and a robot, for programs that replace either: docs/reference/teleop-packets.md.
 *
 * UDP, little-endian, IEEE 754 numbers. Lengths in m, forces in N, in the site frame: its origin at the centre of the
 * soil's first surface, z up. This header needs no library; structures have in memory the layout of packets on the wire, on
 * little-endian machines, so that memcpy() reads and writes them. With a key, 32 bytes follow each packet:
 *
 *     packet || own nonce (16) || BLAKE2b(key, the other's nonce || packet || own nonce), 16 bytes (RFC 7693)
 *
 * 16 zeros replace the other's nonce until a packet of the other's has carried it.
 */
#ifndef HAPTOLITH_TELEOP_H
#define HAPTOLITH_TELEOP_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define HAPTO_TELEOP_VERSION 1
#define HAPTO_TELEOP_MOST_KEYS 64 /* and reports */

#define HAPTO_TELEOP_SITE_SIDE 16 /* a packet's cells along either side, at most */
#define HAPTO_TELEOP_NOT_SEEN (-32768)

/* Flags of commands. */
#define HAPTO_TELEOP_HELD 1u /* the operator's hand holds the tool; without it the robot stops */
#define HAPTO_TELEOP_TARE 2u /* the force sensor is to find a new zero, when it next hangs still in the air */

/* Flags of states. */
#define HAPTO_TELEOP_AT_FORCE_CAP 1u
#define HAPTO_TELEOP_AT_SPEED_CAP 2u
#define HAPTO_TELEOP_AT_EDGE 4u /* at the edge of its workspace */

/* States of a robot. */
enum {
  HAPTO_ROBOT_TARING = 0,
  HAPTO_ROBOT_WAITING = 1,
  HAPTO_ROBOT_APPROACHING = 2, /* automatically: up, across, and down to the operator's tool */
  HAPTO_ROBOT_FOLLOWING = 3,
  HAPTO_ROBOT_HOLDING = 4,
  HAPTO_ROBOT_RETRACTING = 5,
  HAPTO_ROBOT_FAILED = 6
};

/* Why it stopped, last; HAPTO_STOP_NONE again once it follows. */
enum {
  HAPTO_STOP_NONE = 0,
  HAPTO_STOP_SILENCE = 1,
  HAPTO_STOP_RELEASED = 2,
  HAPTO_STOP_JUMP = 3,
  HAPTO_STOP_GAP = 4,
  HAPTO_STOP_FORCE = 5,
  HAPTO_STOP_RESTART = 6,
  HAPTO_STOP_FAULT = 7
};

#pragma pack(push, 1)

/* Operator to robot: this, then `keys` keys, the oldest first. Older ones repeat what earlier packets may have lost. */
typedef struct hapto_teleop_command_header {
  char magic[4];        /* "HLTC" */
  uint16_t version;     /* HAPTO_TELEOP_VERSION */
  uint16_t flags;       /* HAPTO_TELEOP_HELD, HAPTO_TELEOP_TARE */
  uint32_t session;     /* drawn at the operator's start, not 0 */
  uint32_t keys;        /* 1 to HAPTO_TELEOP_MOST_KEYS */
  uint64_t number;      /* of this packet, one more with each */
  uint64_t sender_time; /* returned in states; in the operator's own unit */
} hapto_teleop_command_header;

typedef struct hapto_teleop_command_key {
  uint64_t index;                  /* index of the operator's tick, one per millisecond */
  float position_m[3];             /* tool's origin; each within 10 m */
  float orientation_wxyz[4];       /* turns the tool's frame into the site's; of unit length within 1 % */
  float velocity_m_s[3];           /* each within 100 m/s */
  float angular_velocity_rad_s[3]; /* each within 1000 rad/s */
  float opening;                   /* of jaws, 0 closed to 1 wide open */
} hapto_teleop_command_key;

/* Robot to operator: this, then `reports` reports, the oldest first. */
typedef struct hapto_teleop_state_header {
  char magic[4];             /* "HLTS" */
  uint16_t version;          /* HAPTO_TELEOP_VERSION */
  uint16_t flags;            /* HAPTO_TELEOP_AT_... */
  uint32_t operator_session; /* whose commands it has; 0: none yet */
  uint32_t robot_session;    /* drawn at the robot's start, not 0 */
  uint64_t number;           /* of this packet, one more with each */
  uint64_t sender_time;      /* the operator's, in the newest packet that it has had */
  uint64_t newest;           /* index of the newest command that it has had */
  uint8_t state;             /* HAPTO_ROBOT_... */
  uint8_t reason;            /* HAPTO_STOP_... */
  uint16_t reports;          /* 1 to HAPTO_TELEOP_MOST_KEYS */
  uint32_t zero;
} hapto_teleop_state_header;

typedef struct hapto_teleop_robot_report {
  uint64_t index; /* index of its last executed command; grows from report to report */
  uint32_t ticks; /* commands up to that one that force and torque are the mean over; 0: it followed none */
  uint32_t zero;
  float position_m[3]; /* tool's origin */
  float orientation_wxyz[4];
  float force_n[3];   /* soil on tool, the tool's weight and the sensor's zero subtracted */
  float torque_nm[3]; /* about the tool's origin */
  float zero_too;
} hapto_teleop_robot_report;

/* Robot to operator, from robots that see their site: this, then columns x rows heights (int16_t) over the site's zero,
 * row by row, in steps of 0.1 mm. Optional. */
typedef struct hapto_teleop_site_header {
  char magic[4];          /* "HLTM" */
  uint16_t version;       /* HAPTO_TELEOP_VERSION */
  uint16_t zero;
  uint32_t robot_session; /* as in states */
  uint16_t map_columns;   /* of the whole map, along x; 1 to 1024 */
  uint16_t map_rows;      /* along y; 1 to 1024; columns times rows 65536 at most */
  float corner_m[2];      /* x, y of the corner of the map's first cell; each within 100 m */
  float cell_m;           /* width of a cell; 1e-4 to 1 */
  uint16_t column;        /* first one that the packet is about */
  uint16_t row;
  uint16_t columns;       /* columns of the packet: 1 to HAPTO_TELEOP_SITE_SIDE */
  uint16_t rows;
  uint32_t zero_too;
  uint64_t number; /* number of this packet, incremented with each; separate from that of states */
  uint64_t index;  /* index of the robot's last executed command at the time of the view */
} hapto_teleop_site_header;

#pragma pack(pop)

#ifdef __cplusplus
}
#endif

#endif
