; SPDX-License-Identifier: BSD-3-Clause
;
; The program of the small engine: the framed protocol of docs/protocol.md, for framed_small.vhd.
;
; docs/gateware/framed_small.md explains the instructions. tools/small/assemble.py turns this file into
; small_program_pkg.vhd and docs/gateware/small-program.md. There are two programs: with publishing, and without.
;
;   .at A        the next byte of the data memory       .let NAME = V   a name for a value
;   .var NAME N  N bytes of the data memory             #V   the value V    V   the byte at V    [x]   the byte at X
;   name:        a place in the program                 [x+] the same, then X goes to the next byte
;   .if NAME     the lines up to .end are only in the program NAME: plain, or publishing
;
; Each instruction takes two clocks. Numbers have the most significant byte first, as on the wire.

; ==== Data memory ====

.at 0
.var description 60     ; control registers from `magic` on, 4 bytes each: the settings
.var window             ; W
.var window_mask        ; W - 1
.var post_size          ; of a POST: its bytes in the ring
.var write_bytes        ; A + D
.at 0x40
.var replies 64         ; the reply of each place: its bytes after `posts`, at most 8
.at 0x80
.var counters 72        ; control registers from `frames` on
.var nonce_h            ; of the last HELLO answer; a reset keeps it
.var nonce_l
.var epoch_h            ; FF: no session is open
.var epoch_l
.var a_bytes            ; bytes of an address
.var d_bytes            ; bytes of a word
.var own_h              ; nonce of the session
.var own_l
.var head               ; ring: the first frame that is not executed
.var look               ; ring: the first piece that is not checked
.var after              ; ring: behind its 00
.var size               ; of a piece: its bytes in the ring, with its 00
.var kind
.var rest               ; bytes that are left
.var id_h
.var id_l
.var barrier_h
.var barrier_l
.var here               ; X, for later
.var record             ; the place of the id: its address in `places`
.var status             ; of the reply
.var count
.var repeated           ; the request was executed before
.var scratch
.at 0xE0
.var places 32          ; of each: id (low byte first), status (FF: nothing executed), bytes kept (FF: not kept)
.at 0x100
.var time_low 4         ; control registers
.var time_high 4
.var deadman_ticks 4    ; a session begins with zeros from here to `first_status`
.var arm 4
.var publish 4
.var posts_h            ; posts executed
.var posts_l
.var failed_h           ; posts that failed
.var failed_l
.var first_h            ; the number of the first of them
.var first_l
.var first_status
.var turns 6            ; the clock, above the 16 bits of the hardware; low byte first
.var offered            ; a HELLO answer was sent that no OPEN has used
.var told               ; CLOSED was sent since the last HELLO
.var over               ; the piece at `look` is too long, and its beginning is dropped
.var paused             ; an OPEN or CLOSE was checked: the next frame is for another session
.var closing            ; the session ends when the reply is on its way
.var due                ; groups whose rate is reached: group g is bit g
.var served             ; the group that was published last: its byte in `groups`
.let cleared = served + 1    ; a reset makes all zero from `time_low` to here
.var outside            ; zero: the piece is HELLO or OPEN
.var control            ; number of a control register
.var controls           ; how many of them
.var high
.var low
.var last_group         ; the highest group: its byte in `groups`
.at 0x12E
.var reply 82           ; kind, COBS, check, 00
.at 0x180
.var ring 128           ; bytes as they came; a frame that was checked: kind or counter, size, payload
.at 0x200
.var groups 192         ; of each group 32 bytes, see below
.var enabled            ; groups that publish at their event, as bits

; A group: its bit (never written), whether it runs by its rate, strobes so far, rate, sequence, words, addresses.
; Strobes and rate have the low byte first.
.let group_bytes = 32
.let group_runs = 1
.let group_strobes = 2
.let group_rate = 4
.let group_sequence = 6
.let group_words = 8
.let groups_max = SMALL_ENGINE_GROUPS_MAX
.let address_bytes_max = SMALL_ENGINE_GROUP_ADDRESS_BYTES
.let rate_bytes = SMALL_ENGINE_RATE_BYTES

; Names for the same bytes in other parts of the program.
.let end = rest         ; of the reply: behind its payload
.let found = rest       ; the address of a place
.let code = barrier_h   ; of the reply: where the code of this block stands
.let past = barrier_l
.let group = rest       ; its byte in `groups`
.let bit = barrier_h    ; of a group
.let flags = barrier_l  ; of DEFINE_GROUP
.let wanting = low      ; groups that have something to publish
.let past_group = kind  ; in `groups`: behind what was copied
.let group_end = rest   ; of the publish: behind its words

; A counter is named by its lowest byte, where `bump` begins.
.let frames = counters + 3
.let discarded_check = frames + 4 * (CONTROL_DISCARDED_CHECK - CONTROL_FRAMES)
.let discarded_kind = frames + 4 * (CONTROL_DISCARDED_KIND - CONTROL_FRAMES)
.let discarded_session = frames + 4 * (CONTROL_DISCARDED_SESSION - CONTROL_FRAMES)
.let discarded_stale = frames + 4 * (CONTROL_DISCARDED_STALE - CONTROL_FRAMES)
.let discarded_long = frames + 4 * (CONTROL_DISCARDED_LONG - CONTROL_FRAMES)
.let duplicates = frames + 4 * (CONTROL_DUPLICATES - CONTROL_FRAMES)
.let posts = frames + 4 * (CONTROL_POSTS - CONTROL_FRAMES)
.let posts_ahead = frames + 4 * (CONTROL_POSTS_AHEAD - CONTROL_FRAMES)
.let posts_old = frames + 4 * (CONTROL_POSTS_OLD - CONTROL_FRAMES)
.let post_errors = frames + 4 * (CONTROL_POST_ERRORS - CONTROL_FRAMES)
.let bus_errors = frames + 4 * (CONTROL_BUS_ERRORS - CONTROL_FRAMES)
.let bus_timeouts = frames + 4 * (CONTROL_BUS_TIMEOUTS - CONTROL_FRAMES)
.let receive_overruns = frames + 4 * (CONTROL_RECEIVE_OVERRUNS - CONTROL_FRAMES)
.let publishes = frames + 4 * (CONTROL_PUBLISHES - CONTROL_FRAMES)
.let publish_overruns = frames + 4 * (CONTROL_PUBLISH_OVERRUNS - CONTROL_FRAMES)
.let refused = frames + 4 * (CONTROL_REFUSED - CONTROL_FRAMES)
.let trips = frames + 4 * (CONTROL_DEADMAN_TRIPS - CONTROL_FRAMES)

; Sizes. A payload has 6 bytes less than its frame: kind, code, check, 00.
.let request_max = SMALL_ENGINE_REQUEST_MAX
.let reply_max = SMALL_ENGINE_REPLY_MAX
.let credit = SMALL_ENGINE_CREDIT
.let cache_bytes = SMALL_ENGINE_CACHE_BYTES
.let window_max = SMALL_ENGINE_WINDOW_MAX
.let around = 6
.let longest = request_max + 7           ; bytes between borders, as docs/protocol.md counts them
.let data = reply + 6                    ; of the reply, behind kind, code, id and posts
.let not_kept = 0xFF
.let arm_publishing = 4                  ; of the control register `arm`
.let not_executed = 0xFF

; The byte `status`, which the hardware gives.
.let is_tripped = 0x01
.let is_running = 0x02
.let is_full = 0x04                       ; the ring
.let is_tripped_now = 0x08
.let bus_answer = 0x30                   ; 00 ok, 10 error, 20 silent, 30 denied
.let bus_silent = 0x20
.let is_overrun = 0x80
.let is_uncounted = 0x40

; The byte `wants`, which the hardware gives: what else wants the program.
.let wants_turn = 0x80
.let wants_strobe = 0x40
.let wants_event = 0x3F                  ; the event of group g is bit g

; ==== Program ====

; ---- After a reset

start:      ldx counters
            ld #nonce_h
            call clear
            ldx time_low
            ld #cleared & 0xFF
            call clear
            ld #ring & 0xFF             ; addresses of the ring in eight bits
            st head
            st look
            ld #0xFF
            st epoch_h
            st epoch_l

; ---- What is next: the clock, events, a frame to execute, bytes to check

next:       jnalert now
.if publishing
            in wants
            and #wants_turn
            jz wanted
.end
            call turn
now:        in status
            and #is_overrun + is_uncounted
            jnz events
            ld head
            xor look
            jz listen

; ---- Execute the frame at `head`

            ld head
            tax 1
            ld [x+]
            st kind
            ld [x+]
            st size
            ld kind
            and #0x80
            jz dropped
            ld kind
            xor #REQUEST_KIND_POST
            jz post
            xor #REQUEST_KIND_POST ^ REQUEST_KIND_POST_LIST
            jz drop_kind                ; there are no lists
            jsending listen             ; the reply needs its room
.if publishing
            jalert next                 ; a publish goes first
.end
            ld #0
            st repeated
            ld kind
            xor #REQUEST_KIND_HELLO
            jz hello
            xor #REQUEST_KIND_HELLO ^ REQUEST_KIND_OPEN
            jz open

; A request: the head, the form, the place

            ld size
            sub #around + 2
            jnc drop_kind               ; no id
            st rest
            ld [x+]
            st id_h
            ld [x+]
            st id_l
            ld kind
            and #FRAME_BARRIER_BIT
            jz headed
            ld rest
            sub #2
            jnc invalid
            st rest
            ld [x+]
            st barrier_h
            ld [x+]
            st barrier_l
headed:     in x
            st here
            ld kind
            and #0x0F
            sub #REQUEST_KIND_READ % 16
            jz read
            sub #REQUEST_KIND_WRITE - REQUEST_KIND_READ
            jz write
            sub #REQUEST_KIND_READ_CONTROL - REQUEST_KIND_WRITE
            jz read_control
            sub #REQUEST_KIND_WRITE_CONTROL - REQUEST_KIND_READ_CONTROL
            jz write_control
            sub #REQUEST_KIND_SYNC - REQUEST_KIND_WRITE_CONTROL
            jz sync
            sub #REQUEST_KIND_CLOSE - REQUEST_KIND_SYNC
            jz close
.if publishing
            add #REQUEST_KIND_CLOSE - REQUEST_KIND_DEFINE_GROUP
            jz define_group
.end
invalid:    ld #REPLY_STATUS_INVALID

; Refuse the request with status A: nothing is executed, and no place is taken.
refuse:     st status
            ld #0
            st count
            ld repeated
            jnz answer
            ld #frames
            call bump
            jmp answer

; The words on the bus

read:       ld rest
            xor a_bytes
            jnz invalid
            call judge
            ld a_bytes
            call take_address
            out read
            ld #frames
            call bump
            call await
            jnz unanswered
            call slot
            ld #4                       ; the word is in the low bytes of `data`
            sub d_bytes
            jz aligned
align:      out shift_data
            sub #1
            jnz align
aligned:    ld d_bytes
            st count
keep:       st scratch
            in data
            st [x+]
            out shift_data
            ld scratch
            sub #1
            jnz keep
            jmp executed                ; A is zero: ok

write:      ld rest
            xor write_bytes
            jnz invalid
            call judge
            ld a_bytes
            call take_address
            ld d_bytes
            call take_word
            out write
            ld #frames
            call bump
            call await
            jnz unanswered
            st count                    ; A is zero: nothing is kept
            jmp executed

; A payload byte after the other to the address, or to the word.
take_address: out shift_address [x+]
            sub #1
            jnz take_address
            ret

take_word:  out shift_data [x+]
            sub #1
            jnz take_word
            ret

await:      jaccess await
            in status
            and #bus_answer
            ret

; The bus has refused, or not answered, or the dead-man has tripped: then it has denied the write.
unanswered: sub #bus_silent
            jz silent
            jc denied
            ld #REPLY_STATUS_BUS_ERROR
            st status
            ld #bus_errors
            jmp fails
silent:     ld #REPLY_STATUS_BUS_TIMEOUT
            st status
            ld #bus_timeouts
            jmp fails
denied_new: ld #frames
            call bump
denied:     ld #REPLY_STATUS_DENIED
            st status
            ld #refused
fails:      call bump
            ld kind
            xor #REQUEST_KIND_POST
            jz post_failed
            ld #0
            st count
            ld status
            xor #REPLY_STATUS_DENIED
            jz answer                   ; nothing was executed
            jmp told_once

; The request was executed with status A, and `count` bytes of its reply are in its slot.
executed:   st status
told_once:  call remember

; Send the reply: status, id, posts, `count` kept bytes.
answer:     call reply_head
            ld count
            jz answered
            call slot
            ld count
            call put_bytes
answered:   ld count
            add #data & 0xFF

; Send the reply whose payload ends before A.
finish:     call seal
            ld closing
            jnz closed

; The frame is done: its room in the ring is free.
done:       ld head
            add size
            or #0x80
            st head
            out free
            xor look
            jnz next
            st paused
            jmp next

; ---- Frames that are not executed

dropped:    ld kind
            xor #discarded_session & 0x7F
            jnz drop
            ld told
            jnz drop
            jsending listen
            ld #1
            st told
            ld #discarded_session
            call bump
            ld #DEVICE_KIND_CLOSED
            put
            put
            ld #(reply + 2) & 0xFF
            jmp finish
drop:       ld kind
            or #0x80
            jmp drop_at
drop_kind:  ld #discarded_kind
            jmp drop_at
stale:      ld #discarded_stale
drop_at:    call bump
            jmp done

; ---- Events

events:     and #is_overrun
            jz trip
            tell overrun_seen
            ld #receive_overruns
            jmp event_end
trip:       tell counted                ; the dead-man has tripped
            ldx deadman_ticks
            ld #arm & 0xFF
            call clear
            ld #trips
event_end:  call bump
            jmp next

; ---- Check a piece that has come: between two borders

listen:     ld paused
            jnz next
            jnpiece none
            note piece_taken
            ld look
            tax 1
            ld [x]
            st kind
find:       ld [x+]
            jnz find
            in x                        ; X is behind the 00
            st after
            sub look
            and #0x7F
            st size
            ld look
            tax 1
            ld over
            jnz was_long
            ld size
            sub #longest + 2
            jc is_long
            ld size
            sub #around
            jnc is_short
            add #1
            st rest                     ; bytes that are left: the COBS blocks
            out crc_clear
            ld kind
            and #0xFE
            xor #REQUEST_KIND_HELLO
            st outside                  ; zero: HELLO or OPEN
            jz seed_outside
            ld epoch_h
            xor #0xFF
            jz no_session
            ld [x+]
            xor epoch_l
            out crc
            ld [x]
            xor epoch_h
            out crc
            jmp decode_block
is_short:   ld kind                     ; nothing to check, but a session is asked for all the same
            and #0xFE
            xor #REQUEST_KIND_HELLO
            jz is_wrong
            ld epoch_h
            xor #0xFF
            jz no_session
            jmp is_wrong
seed_outside: call seed
            jmp decode_block
decode_code: out crc [x]                ; a code: a zero of the payload
decode_block: ld rest
            sub [x]
            jnc is_wrong                ; the block is cut
            st rest
            ld [x]
            clr [x+]
            sub #1
            jz decode_end
decode_byte: out crc [x+]
            sub #1
            jnz decode_byte
decode_end: ld rest
            jnz decode_code
            in check
            xor [x+]
            jnz is_wrong
            tell check_next
            in check
            xor [x+]
            jnz is_wrong
            tell check_next
            in check
            xor [x]
            jnz is_wrong
            ld outside
            jz is_outside
            ld size
            sub #request_max + around + 1
            jc is_long
            ld kind
            xor #REQUEST_KIND_POST
            jz is_alive
            ld kind
            and #FRAME_DEVICE_BIT
            jnz is_unknown
            ld kind
            and #0x0D
            xor #REQUEST_KIND_POST % 16 ; POST, or POST_LIST: no bit may be set
            jnz is_request
            ld kind
            and #FRAME_CHAINED_BIT + FRAME_BARRIER_BIT
            jnz is_unknown
is_request: ld kind
            and #0x0F
            xor #REQUEST_KIND_CLOSE % 16
            jnz is_alive
            ld #1
            st paused
is_alive:   tell alive
is_right:   ld look
            jmp judged_kind
is_outside: ld kind
            and #1
            jz is_right
            st paused                   ; an OPEN
            jmp is_right
was_long:   ld #0
            st over
is_long:    ld #discarded_long & 0x7F
            jmp judged
no_session: ld #discarded_session & 0x7F
            jmp judged
is_wrong:   ld #discarded_check & 0x7F
            jmp judged
is_unknown: ld #discarded_kind & 0x7F
judged:     st kind
            ld look
judged_kind: tax 1
            ld kind
            st [x+]
            ld size
            st [x+]
            ld after
            st look
            jmp next

none:       in status
            and #is_full
            jz next
            jpiece next                 ; it has come just now; while the ring is full nothing comes
            ld head
            xor look
            jnz next
            ld #1                       ; nothing waits, and no frame is so long: keep the last byte
            st over
            ld head
            add #126
            or #0x80
            st look
            st head
            out free
            jmp next

; ---- Sessions

hello:      ld size
            xor #2 + around
            jnz drop_kind
            st told                     ; A is zero
            ld #1
            st offered
            ld nonce_l
            add #1
            st nonce_l
            ld nonce_h
            adc #0
            st nonce_h
            ld #DEVICE_KIND_HELLO
            put
            put
            ld [x+]                     ; both speak version 1, or none
            and #0xFE
            jnz hello_none
            ld [x]
            jz hello_more
            ld #FRAME_VERSION
            jmp hello_more
hello_none: ld #0
hello_more: put
            ldx nonce_h                 ; nonce, epoch, A, D
            ld #6
            call put_bytes
            ldx description + 4 * CONTROL_REQUEST_CREDIT + 2
            ld #6                       ; credit, request_max, reply_max
            call put_bytes
            ld window
            put
            ld #cache_bytes
            put
            ldx description + 4 * CONTROL_FEATURES + 2
            ld #2
            call put_bytes
            ldx description + 4 * CONTROL_SPEC_HASH_HIGH
            ld #8
            call put_bytes
            ld #frames
            call bump
            ld #(reply + 2 + 25) & 0xFF
            jmp finish

open:       ld size
            xor #5 + around
            jnz drop_kind
            out time
            jalert next                ; count the turn first
            in x
            st here
            ld epoch_h
            xor #0xFF
            jz open_new                 ; none is open
            ld [x+]                     ; the open session once more?
            xor own_h
            jnz open_new
            ld [x+]
            xor own_l
            jnz open_new
            ld [x+]
            xor epoch_h
            jnz open_new
            ld [x+]
            xor epoch_l
            jz opened
open_new:   ld offered
            jz stale
            ld here
            tax 1
            ld [x+]
            xor nonce_h
            jnz stale
            ld [x+]
            xor nonce_l
            jnz stale
            ld [x+]
            st id_h
            xor #0xFF
            jz stale
            ld [x+]
            st id_l
            ld [x]
            jnz stale                   ; a flag is set
            st offered
            tell trip                   ; if the dead-man runs
            ld nonce_h
            st own_h
            ld nonce_l
            st own_l
            ld id_h
            st epoch_h
            ld id_l
            st epoch_l
            call session
opened:     ld #frames
            call bump
            ld #DEVICE_KIND_OPEN
            put
            put
            ldx epoch_h
            ld #2
            call put_bytes
            call clock
            ldx time_low
            ld #4
            call put_bytes
            ld #(reply + 2 + 6) & 0xFF
            jmp finish

close:      ld rest
            jnz invalid
            call judge
            ld #1
            st closing
            ld #frames
            call bump
            ld #0
            st count
            jmp executed

closed:     ld #0                       ; the reply of CLOSE is on its way
            st closing
            ld #0xFF
            st epoch_h
            st epoch_l
            call session
            jmp done

; A session begins or has ended: nothing was executed in it.
session:    tell renew
            ldx deadman_ticks
            ld #(first_status + 1) & 0xFF
            call clear
.if publishing
            note publishing             ; A is zero: off
            note enabled
            ldx enabled
            st [x]
            ld #0xFF
            note events_taken
            ld last_group
session_group: st scratch
            or #group_runs
            tax 2
            clr [x]
            ld scratch
            sub #group_bytes
            jc session_group
            ld #0
.end
            sub window                  ; A is zero; place i holds i - W
            ldx places
session_place: st [x+]
            st scratch
            ld #0xFF
            st [x+]
            st [x+]
            st [x+]
            ld scratch
            add #1
            jnz session_place
            ret

; ---- Posts

post:       ld size
            xor post_size
            jnz drop_kind
            ld [x+]
            st id_h
            ld [x+]
            st id_l
            sub posts_l
            st scratch
            ld id_h
            sbc posts_h
            st count
            or scratch
            jnz post_other
            ld posts_l
            add #1
            st posts_l
            jnc post_write
            ld posts_h
            add #1
            st posts_h
post_write: ld a_bytes
            call take_address
            ld d_bytes
            call take_word
            out write
            ld #posts
            call bump
post_wait:  jaccess post_wait
            in status
            and #bus_answer
            jz done
            jmp unanswered
post_other: ld count
            and #0x80
            jnz post_old
            ld #posts_ahead
            jmp drop_at
post_old:   ld #posts_old
            jmp drop_at

post_failed: ld #post_errors
            call bump
            ld failed_h
            or failed_l
            jnz post_noted
            ld status
            st first_status
            ld id_h
            st first_h
            ld id_l
            st first_l
post_noted: ld failed_l                 ; it stops at FFFF
            add #1
            st scratch
            ld failed_h
            adc #0
            jc done
            st failed_h
            ld scratch
            st failed_l
            jmp done

; ---- The place of a request. Returns if the request may be executed

judge:      ld id_h
            st high
            ld id_l
            call distance
            st record
            ld count
            or scratch
            jz not_new
            ld count
            and #0x80
            jnz stale
            ld kind
            and #FRAME_CHAINED_BIT
            jz not_chained
            ld id_h                     ; the id before this one: it, or a later one, must have been executed
            st high
            ld id_l
            sub #1
            jc before
            st scratch
            ld high
            sub #1
            st high
            ld scratch
before:     call distance
            ld count
            or scratch
            jz not_chained
            ld count
            sub #0x80
            jnc order
            or scratch
            jz order
not_chained: ld kind
            and #FRAME_BARRIER_BIT
            jz may
            ld barrier_h
            xor posts_h
            jnz behind
            ld barrier_l
            xor posts_l
            jnz behind
may:        ld here
            tax 1
            ret

order:      ld #REPLY_STATUS_ORDER
            jmp refuse
behind:     ld #REPLY_STATUS_BEHIND
            jmp refuse

not_new:    ld [x+]                     ; the status of the place
            st status
            xor #not_executed
            jz stale
            ld [x]
            st count
            ld #duplicates
            call bump
            ld count
            xor #not_kept
            jnz answer                  ; as before
            ld #1
            st repeated
            ld kind
            and #0x0F
            xor #REQUEST_KIND_READ_CONTROL % 16
            jnz invalid                 ; the id was another request's
            ld here
            tax 1
            jmp registers

; How far the id `high`, A is ahead of the id of its place: `count`, `scratch`. A is the address of the place, and X is
; behind its id.
distance:   st low
            and window_mask
            st scratch
            add scratch
            st scratch
            add scratch
            or #places
            tax 0
            st found
            ld low
            sub [x+]
            st scratch
            ld high
            sbc [x+]
            st count
            ld found
            ret

; Let the id take its place.
remember:   ld record
            tax 0
            ld id_l
            st [x+]
            ld id_h
            st [x+]
            ld status
            st [x+]
            ld count
            st [x+]
            ret

; X is the kept reply of the place.
slot:       ld record
            and #0x1C
            st scratch
            add scratch
            or #replies
            tax 0
            ret

; ---- SYNC, control registers

sync:       ld rest
            jnz invalid
            call judge
            ld #frames
            call bump
            ld #REPLY_STATUS_OK
            st status
            call reply_head
            ldx posts_h
            ld #7
            jmp put_reply

read_control: ld rest
            xor #3
            jnz invalid
            ld [x+]
            ld [x+]
            ld [x]
            jz invalid                  ; a count of 0
            out time
            jalert next                ; count the turn first
            call judge
registers:  ld [x+]
            jnz bad_address
            ld [x+]
            st control
            ld [x]
            st controls
            ld control                  ; three blocks; A is how far it is from the end of the block
            sub #CONTROL_SPEC_HASH_LOW + 1
            jnc block
            sub #CONTROL_FRAMES - (CONTROL_SPEC_HASH_LOW + 1)
            jnc bad_address
            sub #CONTROL_DEADMAN_TRIPS + 1 - CONTROL_FRAMES
            jnc block
            sub #CONTROL_TIME_LOW - (CONTROL_DEADMAN_TRIPS + 1)
            jnc bad_address
            sub #CONTROL_PUBLISH + 1 - CONTROL_TIME_LOW
            jnc block
bad_address: ld #REPLY_STATUS_BAD_ADDRESS
            jmp refuse
block:      add controls
            jnc inside
            jnz bad_address
inside:     ld repeated
            jnz seen
            ld #frames
            call bump
seen:       ld #REPLY_STATUS_OK
            st status
            call reply_head
            in status
            and #is_tripped + is_running
            st arm + 3
.if publishing
            ld publish + 3
            jz arm_seen
            ld #arm_publishing
            or arm + 3
            st arm + 3
arm_seen:
.end
            ld control
            xor #CONTROL_TIME_LOW
            jnz now_seen
            call clock
now_seen:   ld controls
            add controls
            st scratch
            add scratch
            st scratch                  ; bytes
            ld control
            add control
            st count
            add count                   ; 4 times the number: the address
            jc page_1
            tax 0
            jmp page
page_1:     tax 1
page:       ld scratch

; Put A bytes from X to the reply, and finish it. Keep a copy if it is short.
put_reply:  st count
            st rest
            call put_bytes
            ld repeated
            jnz put_end
            ld count
            sub #cache_bytes + 1
            jnc put_kept
            ld #not_kept
            st count
            call remember
put_end:    ld rest
            add #data & 0xFF
            jmp finish
put_kept:   call remember
            call slot
            in x
            st past
            ld #data & 0xFF
            st code
put_keep:   ld code
            tax 1
            ld [x+]
            st scratch
            in x
            st code
            ld past
            tax 0
            ld scratch
            st [x+]
            in x
            st past
            ld code
            sub count
            xor #data & 0xFF
            jnz put_keep
            jmp put_end

write_control: ld rest
            xor #6
            jnz invalid
            call judge
            ld [x+]
            jnz bad_address
.if publishing
            ld [x]
            xor #CONTROL_PUBLISH
            jz write_publish
.end
            ld description + 4 * CONTROL_FEATURES + 3
            and #CONTROL_VALUE_FEATURE_DEADMAN
            jz bad_address
            ld [x+]
            sub #CONTROL_DEADMAN_TICKS
            jz write_ticks
            sub #CONTROL_ARM - CONTROL_DEADMAN_TICKS
            jnz bad_address
            ld [x+]                     ; only the value 1
            or [x+]
            or [x+]
            jnz invalid
            ld [x]
            xor #1
            jnz invalid
            in status
            and #is_tripped_now
            jnz denied_new
            tell arm
            jmp controlled
write_ticks: in status
            and #is_tripped
            jnz denied_new
            ld [x]
            st deadman_ticks
            out shift_data [x+]
            ld [x]
            st deadman_ticks + 1
            out shift_data [x+]
            ld [x]
            st deadman_ticks + 2
            out shift_data [x+]
            ld [x]
            st deadman_ticks + 3
            out shift_data [x+]
            tell start
controlled: ld #frames
            call bump
            ld #0
            st count
            jmp executed

; ---- Publishing

.if publishing
write_publish: ld [x+]
            ld [x+]                     ; only the values 0 and 1
            or [x+]
            or [x+]
            jnz invalid
            ld [x]
            and #0xFE
            jnz invalid
            ld [x]
            xor publish + 3
            jz controlled               ; it is so already
            ld [x]
            st publish + 3
            note publishing
            jmp controlled

; DEFINE_GROUP: the form

define_group: ld rest
            sub #7
            jnc invalid
            st rest                     ; bytes of its addresses
            st controls
            ld here
            add #5
            or #0x80
            tax 1
            ld [x+]
            and #0xFF ^ FRAME_EVENT_FLAG
            jnz invalid
            ld [x]                      ; its words
define_form: jz define_formed
            st low
            ld rest
            sub a_bytes
            jnc invalid
            st rest
            ld low
            sub #1
            jmp define_form
define_formed: ld rest
            jnz invalid
            call judge
            ld [x+]
            st control
            sub description + 4 * CONTROL_GROUPS + 1
            jc no_group
            ld [x+]
            or [x+]
            jnz invalid                 ; a longer rate than two bytes
            ld [x+]
            st high
            ld [x+]
            st low
            ld [x+]
            st flags
            ld description + 4 * CONTROL_GROUPS + 3
            sub [x]
            jnc no_group
            ld [x+]
            st count
            in x
            st here
            ld #frames
            call bump

; DEFINE_GROUP: execute it. The strobes so far stay if the new rate is longer than they are. Nothing is due, because a
; publish goes before a request.

            ld control
            st scratch
            add scratch
            st scratch
            add scratch
            st scratch
            add scratch
            st scratch
            add scratch
            st scratch
            add scratch
            st group
            tax 2
            ld [x+]
            st bit
            ld [x+]
            jz define_strobes
            ld [x+]
            sub low
            ld [x]
            sbc high
            jnc define_rate
define_strobes: ld group
            or #group_strobes
            tax 2
            clr [x+]
            clr [x+]
define_rate: ld group
            or #group_rate
            tax 2
            ld low
            st [x+]
            ld high
            st [x+]
            clr [x+]                    ; the sequence begins anew
            clr [x+]
            ld count
            st [x+]
            in x
            st past_group
            ld controls
            jz define_copied
define_copy: ld here
            tax 1
            ld [x+]
            st scratch
            in x
            st here
            ld past_group
            tax 2
            ld scratch
            st [x+]
            in x
            st past_group
            ld controls
            sub #1
            st controls
            jnz define_copy
define_copied: ld group                 ; it runs if it has words and a rate
            or #group_runs
            tax 2
            clr [x]
            ld count
            jz define_event
            ld low
            or high
            st [x]
            ld flags
define_event: st flags                  ; without words there is no event
            ld bit
            note events_taken           ; what came before is not published
            xor #0xFF
            ldx enabled
            and [x]
            st [x]
            ld flags
            jz define_enabled
            ld [x]
            or bit
            st [x]
define_enabled: ld [x]
            note enabled
            ld #0
            st count
            jmp executed
no_group:   ld #REPLY_STATUS_NO_GROUP
            jmp refuse

; Publishing wants the program: a strobe, an event, a group that is due

wanted:     in wants
            and #wants_strobe
            jnz strobe
            jsending now                ; a publish needs the room of the reply
            in wants
            and #wants_event
            or due
            st wanting
            jnz choose
            jmp now

; A strobe: one more for each group that runs

strobe:     note strobe_taken
            ld last_group
scan:       st group
            tax 2
            ld [x+]
            st bit
            ld [x+]
            jz scan_next
            ld [x]
            add #1
            st [x+]
            st low
            ld [x]
            adc #0
            st [x+]
            st high
            ld low
            xor [x+]
            jnz scan_next
            ld high
            xor [x]
            jnz scan_next
            ld group                    ; the rate is reached
            or #group_strobes
            tax 2
            clr [x+]
            clr [x]
            ld due
            and bit
            jz scan_due
            ld #publish_overruns        ; it was due before
            call bump
scan_due:   ld due
            or bit
            st due
            note due
scan_next:  ld group
            sub #group_bytes
            jc scan
            jmp next

; Publish a group: the next one that wants it, downwards and around

choose:     ld served
            sub #group_bytes
            jc chosen
            ld last_group
chosen:     st served
            tax 2
            ld [x]
            and wanting
            jz choose
            st bit
            and due
            jz by_event
            xor due
            st due
            note due
            jmp publish_group
by_event:   ld bit
            note events_taken
publish_group: ld #DEVICE_KIND_PUBLISH
            put
            put                         ; the place of the code
            ld served                   ; its number, turned from the upper three bits into the lower ones
            st scratch
            add scratch
            adc #0
            st scratch
            add scratch
            adc #0
            st scratch
            add scratch
            adc #0
            put
            ld served
            or #group_sequence
            tax 2
            ld #2
            call put_bytes
            ld [x+]
            st count
            in x
            st here
            ld #(reply + 2 + 7) & 0xFF
            st group_end
stamp:      out time
            in wants
            and #wants_turn
            jz stamped
            call turn                   ; count the turn first
            jmp stamp
stamped:    ld turns + 1
            put
            ld turns
            put
            in data
            put
            out shift_data
            in data
            put
            ld #1
            note hold
            ld here
            tax 2
publish_word: ld a_bytes
            call take_address
            out read
            call await
            jnz publish_fails
            ld group_end
            add d_bytes
            st group_end
            ld #4                       ; the word is in the low bytes of `data`
            sub d_bytes
            jz publish_bytes
publish_align: out shift_data
            sub #1
            jnz publish_align
publish_bytes: ld d_bytes
publish_byte: st scratch
            in data
            put
            out shift_data
            ld scratch
            sub #1
            jnz publish_byte
            ld count
            sub #1
            st count
            jnz publish_word
            note hold                   ; A is zero: the bus is free
            ld served
            or #group_sequence + 1
            tax 2
            ld [x]
            add #1
            st [x]
            jnc publish_counted
            ld served
            or #group_sequence
            tax 2
            ld [x]
            add #1
            st [x]
publish_counted: ld #publishes
            call bump
            note publish
            ld group_end
            call seal
            jmp next

; A word could not be read: nothing is sent.
publish_fails: xor #bus_silent
            jz publish_silent
            ld #bus_errors
            jmp publish_failed
publish_silent: ld #bus_timeouts
publish_failed: call bump
            note again
            ld #0
            note hold
            jmp next
.end

; ---- Shared routines

; Increment the counter whose lowest byte is at A. It stops at FFFFFFFF.
bump:       tax 0
            ld [x]
            add #1
            st [x]
            jnc bumped
            in x
            and #3
            jz bump_full
            in x
            sub #1
            jmp bump
bump_full:  ld #0xFF
            st [x+]
            st [x+]
            st [x+]
            st [x+]
bumped:     ret

; Make bytes zero from X on, up to the one at A. A is zero then.
clear:      st scratch
clear_next: clr [x+]
            in x
            xor scratch
            jnz clear_next
            ret

; The 16 bits of the clock have turned.
turn:       tell turn_seen
            ldx turns
turn_next:  ld [x]
            add #1
            st [x+]
            jnc turned
            in x
            xor #offered & 0xFF         ; behind `turns`
            jnz turn_next
turned:     ret

; The clock, as `out time` has found it, in time_low and time_high.
clock:      ldx time_low
            ld turns + 1
            st [x+]
            ld turns
            st [x+]
            in data
            st [x+]
            out shift_data
            in data
            st [x+]
            ld turns + 5
            st [x+]
            ld turns + 4
            st [x+]
            ld turns + 3
            st [x+]
            ld turns + 2
            st [x+]
            ret

; Begin a reply.
reply_head: ld status
            or #DEVICE_KIND_REPLY
            put
            put                         ; the place of the code
            ldx id_h
            ld #2
            call put_bytes
            ldx posts_h
            ld #2
put_bytes:  put [x+]                    ; put A bytes from X on
            sub #1
            jnz put_bytes
            ret

; Send the reply, or the publish, whose payload ends before A: COBS, check, 00.
seal:       st end
            ld #0
            put                         ; so that the search for zeros ends
            ld #(reply + 1) & 0xFF
            st code
            ldx reply + 2
encode:     ld [x+]
            jnz encode
            in x                        ; X is behind a zero
            st past
            sub code
            sub #1
            st scratch
            ld code
            tax 1
            ld scratch
            st [x]
            ld past
            tax 1
            sub #1
            st code
            xor end
            jnz encode
            ldx reply
            ld [x]
.if publishing
            xor #DEVICE_KIND_PUBLISH
            jz sum_session
            ld [x]
.end
            and #0x10                   ; HELLO, OPEN, CLOSED: outside a session
            jnz sum_outside
sum_session: out crc_clear
            ld [x+]
            xor epoch_l
            out crc
            ld [x]
            xor epoch_h
            out crc
            jmp sum_next
sum_outside: call seed
sum_next:   out [x+]
            jmp sum_end
sum:        out crc [x+]
sum_end:    in x
            xor end
            jnz sum
            in check
            st [x+]
            tell check_next
            in check
            st [x+]
            tell check_next
            in check
            st [x+]
            ld #0
            st [x+]
            out send
            ret

; Begin a CRC outside a session: over kind and first code, which are XORed with the first value instead.
seed:       out crc_clear
            ld [x+]
            xor #0xFF
            out crc
            ld [x]
            xor #0xFF
            out crc
            ret
