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
.var ring 128           ; bytes as they came; a frame that was checked: size, kind or counter, payload
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
.let page = outside     ; of the number of a control register: its upper byte


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
.let refusals = frames + 4 * (CONTROL_REFUSED - CONTROL_FRAMES)
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
            set epoch_h
            set epoch_l

; ---- What is next: the clock, events, a frame to execute, bytes to check

next:       jnalert now
.if publishing
            in wants
            and #wants_turn
            jz wanted
.end
            tell turn_seen              ; the 16 bits of the clock have turned
            ldx turns
turn_next:  ld [x]
            add #1
            st [x+]
            jc turn_next                ; all six bytes turn in 2^64 clocks: nobody sees that
now:        in status
            and #is_overrun + is_uncounted
            jnz events
            ld head
            xor look
            jz listen

; ---- Execute the frame at `head`

            follow head
            get size
            get kind
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
            clr repeated
            xor #REQUEST_KIND_POST_LIST ^ REQUEST_KIND_HELLO
            jz hello
            xor #REQUEST_KIND_HELLO ^ REQUEST_KIND_OPEN
            jz open
; A request: the head, the form, the place

            ld size
            sub #around + 2
            jnc drop_kind               ; no id
            st rest
            get id_h
            get id_l
            ld kind
            and #FRAME_BARRIER_BIT
            jz headed
            ld rest
            sub #2
            jnc invalid
            st rest
            get barrier_h
            get barrier_l
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
invalid:    call bump_frames

; Refuse the request: nothing is executed, and no place is taken. `bump_frames` was called.
invalid_counted: ld #REPLY_STATUS_INVALID
refuse:     st status
            clr count
            jmp answer

order:      call bump_frames
            ld #REPLY_STATUS_ORDER
            jmp refuse
behind:     call bump_frames
            ld #REPLY_STATUS_BEHIND
            jmp refuse

; The words on the bus

read:       ld rest
            xor a_bytes
            call judge_form
            call take_address
            out read
            call await
            jnz unanswered
            call slot
            ld d_bytes
            st count
            call keep
            jmp executed                ; A is zero: ok

; A payload byte after the other to the address.
take_address: ld a_bytes
address_byte: out shift_address [x+]
            sub #1
            jnz address_byte
            ret

; The payload is an address and a word: write it. A is zero if the bus has done so.
write_word: call take_address
            ld d_bytes
word_byte:  out shift_data [x+]
            sub #1
            jnz word_byte
            out write
await:      jaccess await
            in status
            and #bus_answer
            ret

; Store A bytes of the word at X. A is zero then.
keep:       st scratch
            in data
            st [x+]
            ld scratch
            sub #1
            jnz keep
            ret

; The bus has refused, or not answered, or the dead-man has tripped: then it has denied the write.
unanswered: sub #bus_silent
            jnz refused
            ld #REPLY_STATUS_BUS_TIMEOUT
            st status
            ld #bus_timeouts
            jmp fails
refused:    ld #REPLY_STATUS_BUS_ERROR
            st status
            ld #bus_errors
            jnc fails
denied:     ld #REPLY_STATUS_DENIED
            st status
            ld #refusals
fails:      call bump
            ld kind
            xor #REQUEST_KIND_POST
            jz post_failed
            ld status
            xor #REPLY_STATUS_DENIED
            jz answer                   ; nothing was executed
            jmp told_once

write:      ld rest
            xor write_bytes
            call judge_form
            call write_word
            jnz unanswered
nothing:    ld #0                       ; ok, and `count` is zero: nothing is kept

; The request was executed with status A, and `count` bytes of its reply are in its slot.
executed:   st status
told_once:  call remember

; Send the reply: status, id, posts, `count` kept bytes.
answer:     call reply_head
            ld count
            jz finish
            call slot
            ld count
            call put_bytes

; Send the reply, or the publish, whose payload was put: COBS, check, 00.
finish:     in place
            st end
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
            follow code
            st [x]
            follow past
            ld past
            sub #1
            st code
            xor end
            jnz encode
            ldx reply
            ld reply
            xor #DEVICE_KIND_PUBLISH
.if publishing
            jz finish_publish
.end
            and #0x10                   ; zero: HELLO, OPEN, CLOSED, which are outside a session
finish_seed: call seed
            out [x+]
            jmp sum_end
sum:        out crc [x+]
sum_end:    in x
            xor end
            jnz sum
            in check
            st [x+]
            in check
            st [x+]
            in check
            st [x+]
            clr [x]
            out send
.if publishing
            ld reply
            xor #DEVICE_KIND_PUBLISH
            jz next
.end
            ld closing
            jnz closed

; The frame is done: its room in the ring is free.
done:       ld head
            add size
            or #0x80
free_head:  st head
            out free
            xor look
            jnz next
            st paused
            jmp next

; ---- Frames that are not executed
dropped:    ld kind
            xor #discarded_session & 0x7F
            or told
            jnz drop
            jsending listen
            set told
            ld #discarded_session
            call bump
            ld #DEVICE_KIND_CLOSED
            st reply
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
            follow look
            get kind
find:       ld [x+]
            jnz find
            in x                        ; X is behind the 00
            st after
            sub look
            and #0x7F
            st size
            follow look
            ld over
            jnz was_long
            ld size
            sub #longest + 2
            jc is_long
            ld kind
            and #0xFE
            xor #REQUEST_KIND_HELLO
            st outside                  ; zero: HELLO or OPEN
            jz has_session
            ld epoch_h
            xor #0xFF
            jz no_session
has_session: ld size
            sub #around - 1
            jnc is_wrong                ; it is too short
            st rest                     ; bytes that are left: the COBS blocks
            ld outside
            call seed
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
            in check
            xor [x+]
            jnz is_wrong
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
            and #0xFF ^ REQUEST_KIND_POST ^ REQUEST_KIND_POST_LIST
            jz is_alive
            and #FRAME_DEVICE_BIT + 0x0D ; POST, or POST_LIST: no bit may be set
            jz is_unknown
            and #FRAME_DEVICE_BIT
            jnz is_unknown
            ld kind
            and #0x0F
            xor #REQUEST_KIND_CLOSE % 16
            jnz is_alive
            set paused
is_alive:   tell alive
            jmp judged_kind
is_outside: ld kind
            and #1
            jz judged_kind
            st paused                   ; an OPEN
            jmp judged_kind
was_long:   clr over
is_long:    ld #discarded_long & 0x7F
            jmp judged
no_session: ld #discarded_session & 0x7F
            jmp judged
is_wrong:   ld #discarded_check & 0x7F
            jmp judged
is_unknown: ld #discarded_kind & 0x7F
judged:     st kind
judged_kind: follow look
            give size
            give kind
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
            ld head                     ; nothing waits, and no frame is so long: keep the last byte
            add #126
            or #0x80
            st over
            st look
            jmp free_head
; ---- Sessions

hello:      ld size
            xor #2 + around
            jnz drop_kind
            st told                     ; A is zero
            ld nonce_l
            add #1
            st nonce_l
            ld nonce_h
            adc #0
            st nonce_h
            ld #DEVICE_KIND_HELLO
            st offered
            st reply
            clr low                     ; both speak version 1, or none
            ld [x+]
            and #0xFE
            jnz hello_version
            ld [x]
            jz hello_version
            ld #FRAME_VERSION
            st low
hello_version: put low
            ldx nonce_h                 ; nonce, epoch, A, D
            ld #6
            call put_bytes
            ldx description + 4 * CONTROL_REQUEST_CREDIT + 2
            ld #6                       ; credit, request_max, reply_max
            call put_bytes
            put window
            ld #cache_bytes
            put
            put description + 4 * CONTROL_FEATURES + 2
            put description + 4 * CONTROL_FEATURES + 3
            ldx description + 4 * CONTROL_SPEC_HASH_HIGH
            ld #8
            call put_bytes
            call bump_frames
            jmp finish

open:       ld size
            xor #5 + around
            jnz drop_kind
            out time
            jalert next                 ; count the turn first
            get high
            get low
            get id_h
            xor #0xFF
            jz stale
            get id_l
            xor epoch_l                 ; the open session once more?
            jnz open_new
            ld id_h
            xor epoch_h
            jnz open_new
            ld low
            xor own_l
            jnz open_new
            ld high
            xor own_h
            jz opened
open_new:   ld offered
            jz stale
            ld high
            xor nonce_h
            jnz stale
            ld low
            xor nonce_l
            jnz stale
            ld [x]
            jnz stale                   ; a flag is set
            st offered
            tell trip                   ; if the dead-man runs
            ldx own_h
            give nonce_h
            give nonce_l
            ldx epoch_h
            give id_h
            give id_l
            call session
opened:     call bump_frames
            ld #DEVICE_KIND_OPEN
            st reply
            put epoch_h
            put epoch_l
            call clock
            ldx time_low
            ld #4
            call put_bytes
            jmp finish

close:      ld rest
            call judge_form
            set closing
            jmp nothing
closed:     clr closing                 ; the reply of CLOSE is on its way
            set epoch_h
            set epoch_l
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
            get id_h
            get id_l
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
            ld posts_h
            adc #0
            st posts_h
post_write: call write_word
            jnz unanswered
post_end:   ld #posts
            jmp drop_at
post_other: ld count                    ; its highest bit
            add count
            ld #posts_old
            jc drop_at
            ld #posts_ahead
            jmp drop_at
post_failed: ld #post_errors
            call bump
            ld first_status
            jnz post_noted
            ldx first_h
            give id_h
            give id_l
            give status
post_noted: ld failed_l                 ; it stops at FFFF
            add #1
            st scratch
            ld failed_h
            adc #0
            jc post_end
            st failed_h
            ld scratch
            st failed_l
            jmp post_end

; ---- The place of a request. Returns if the request may be executed

judge_form: jnz invalid
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
            ld id_l                     ; the id before this one: it, or a later one, must have been executed
            sub #1
            st scratch
            ld id_h
            sbc #0
            st high
            ld scratch
            call distance
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
may:        call bump_frames
            clr count
            follow here
            ret

not_new:    get status                  ; of the place
            xor #not_executed
            jz stale
            get count
            ld #duplicates
            call bump
            ld count
            xor #not_kept
            jnz answer                  ; as before
            set repeated
            ld kind
            and #0x0F
            xor #REQUEST_KIND_READ_CONTROL % 16
            jz registers
            jmp invalid_counted         ; the id was another request's
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
            give id_l
            give id_h
            give status
            give count
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
            call judge_form
            call reply_ok
            ldx posts_h
            ld #7
            jmp put_reply

read_control: ld rest
            xor #3
            jnz invalid
            get page
            get control
            get controls
            jz invalid                  ; a count of 0
            out time
            jalert next                 ; count the turn first
            call judge
registers:  ld page
            jnz bad_address
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
inside:     call reply_ok
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
            tax 0
            jnc put_registers
            tax 1
put_registers: ld scratch

; Put A bytes from X to the reply, and finish it. Keep a copy if it is short.
put_reply:  st count
            call put_bytes
            ld repeated
            jnz finish
            call slot
            give data
            give data + 1
            give data + 2
            give data + 3
            give data + 4
            give data + 5
            give data + 6
            give data + 7
            ld count
            sub #cache_bytes + 1
            jnc put_kept
            set count                   ; not kept
put_kept:   call remember
            jmp finish

write_control: ld rest
            xor #6
            call judge_form
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
            jnz invalid_counted
            ld [x]
            xor #1
            jnz invalid_counted
            in status
            and #is_tripped_now
            jnz denied
            tell arm
            jmp nothing
write_ticks: in status
            and #is_tripped
            jnz denied
            out shift_data [x+]
            out shift_data [x+]
            out shift_data [x+]
            out shift_data [x+]
            tell start
            ldx deadman_ticks
            ld #4
            call keep
            jmp nothing
; ---- Publishing

.if publishing
write_publish: ld [x+]
            ld [x+]                     ; only the values 0 and 1
            or [x+]
            or [x+]
            jnz invalid_counted
            ld [x]
            and #0xFE
            jnz invalid_counted
            ld [x]
            xor publish + 3
            jz nothing                  ; it is so already
            ld [x]
            st publish + 3
            note publishing
            jmp nothing
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
            call judge_form
            get control
            sub description + 4 * CONTROL_GROUPS + 1
            jc no_group
            ld [x+]
            or [x+]
            jnz invalid_counted         ; a longer rate than two bytes
            get high
            get low
            get flags
            ld description + 4 * CONTROL_GROUPS + 3
            sub [x]
            jnc no_group
            get count
            in x
            st here

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
            get bit
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
            give low
            give high
            clr [x+]                    ; the sequence begins anew
            clr [x+]
            give count
            in x
            st past_group
            ld controls
            jz define_copied
define_copy: follow here
            get scratch
            in x
            st here
            ld past_group
            tax 2
            give scratch
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
            clr count
            jmp nothing
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
            get bit
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
            st reply
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
            get count
            in x
            st here
stamp:      out time
            in wants
            and #wants_turn
            jz stamped
            tell turn_seen              ; count the turn first
            ldx turns
stamp_turn: ld [x]
            add #1
            st [x+]
            jc stamp_turn
            jmp stamp
stamped:    put turns + 1
            put turns
            in data
            put
            in data
            put
            ld #1
            note hold
            ld here
            tax 2
publish_word: call take_address
            out read
            call await
            jnz publish_fails
            ld d_bytes
publish_byte: st scratch
            in data
            put
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
            jmp finish
finish_publish: ld #1
            jmp finish_seed

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
bump_frames: ld #frames
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


; The clock, as `out time` has found it, in time_low and time_high.
clock:      ldx time_low
            give turns + 1
            give turns
            in data
            st [x+]
            in data
            st [x+]
            give turns + 5
            give turns + 4
            give turns + 3
            give turns + 2
            ret
; Begin a reply.
reply_ok:   clr status
reply_head: ld status
            or #DEVICE_KIND_REPLY
            st reply
            put id_h
            put id_l
            put posts_h
            put posts_l
            ret

; Put A bytes from X on.
put_bytes:  put [x+]
            sub #1
            jnz put_bytes
            ret

; Begin a CRC: the epoch over kind and first code. Outside a session, where A is zero, the epoch is FFFF.
seed:       set low
            set high
            jz seed_with
            ld epoch_l
            st low
            ld epoch_h
            st high
seed_with:  out crc_clear
            ld [x+]
            xor low
            out crc
            ld [x]
            xor high
            out crc
            ret
